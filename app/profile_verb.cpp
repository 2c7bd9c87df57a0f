#include <fmt/core.h>
#include <sys/wait.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/film_run.h"
#include "app/verbs.h"
#include "base/companion_program.h"
#include "base/console.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "base/timing.h"
#include "film/plan/shipped_files.h"
#include "output/files/child_program.h"
#include "output/files/json_text.h"
#include "output/files/whole_file.h"
#include "output/pages/zone_table.h"
#include "output/run/verdict.h"
#include "output/run/zone_comparison.h"

namespace supple {
namespace {

struct ProfileCommand {
  FilmCommand film;
  int repeats = 10;
  std::vector<std::string> compared;  // two files, or none
  bool anyway = false;                // whether they may be of different settings
  std::string against;                // another program, which runs in turn with this one; empty: none
};

ProfiledRun run_of(const FilmRecord& record) {
  ProfiledRun run;
  run.scene = record.scene;
  run.scene_json = record.info.scene_json;
  run.replay_json = record.info.replay_json;
  for (const RunInfo::Mesh& mesh : record.info.meshes) run.meshes.emplace_back(mesh.body, mesh.hash);
  run.frames = record.result.rows.size();
  run.fps = record.fps;
  run.threads = record.info.threads;
  run.pictures = record.info.gl_renderer;
  run.cpu = cpu_name();
  run.kernels = record.info.kernel_variant;
  run.version = program_version();
  run.build = build_flags();
  run.state_hash = hash_text_form(record.result.tally.last_hash());
  return run;
}

long lost_zones(const std::vector<ThreadTrace>& threads) {
  long lost = 0;
  for (const ThreadTrace& thread : threads) lost += thread.lost;
  return lost;
}

// Writes the profile into the folder and prints a summary of it.
void report(const ProfileCommand& request, const ZoneProfile& profile, const std::filesystem::path& folder) {
  write_whole_file(folder / "zones.json", zones_json(profile));
  std::string no_plot;
  std::error_code error;
  const bool traced = std::filesystem::exists(folder / "trace.json", error);  // a repeat that was killed left none
  const bool plotted = write_plot(frame_time_plot(profile), folder, &no_plot);
  if (request.film.json) {
    say(stdout, summary_json(profile));
  } else if (!request.film.plan.quiet) {
    say(stdout, fmt::format("\n{}\n  zones    {}\n", zone_table(profile), (folder / "zones.json").string()));
    if (traced) say(stdout, fmt::format("  trace    {}\n", (folder / "trace.json").string()));
    if (plotted) say(stdout, fmt::format("  plot     {}\n", (folder / "frame-times.svg").string()));
    say(stdout, fmt::format("  {}\n", verdict(work_of(profile))));
  }
  if (!plotted) say(stderr, fmt::format("note: {}\n", no_plot));
}

// Profiles one run in this process.
int profile_once(const ProfileCommand& request, const std::vector<std::string>& command) {
  FilmCommand film = request.film;
  film.plan.trace = true;
  film.plan.force = true;  // each repeat replaces the one before
  film.plan.video = false;
  film.json = film.table = false;
  FilmRecord record;
  const int status = run_film(film, command, &record);
  if (status != 0) return status;
  if (const long lost = lost_zones(record.trace); lost > 0)
    throw RunError(fmt::format("{} zones found no room; profile fewer frames (--frames)", lost));
  ZoneCollector zones(run_of(record));
  zones.add(record.trace);
  report(request, zones.result(), record.folder);
  return 0;
}

// Returns the path of zones.json: the name itself, or the file in a profile's folder of that name.
std::string zones_file(const std::string& name) {
  std::error_code error;
  return std::filesystem::is_directory(name, error) ? (std::filesystem::path(name) / "zones.json").string() : name;
}

int compare(const ProfileCommand& request) {
  const std::string before_name = zones_file(request.compared[0]), after_name = zones_file(request.compared[1]);
  const ZoneProfile before = read_zones(before_name), after = read_zones(after_name);
  std::vector<Problem> problems;
  // Zones are compared frame by frame, so that both must have the same frames, whatever else differs.
  const bool forgiven = request.anyway && before.run.frames == after.run.frames;
  for (const std::string& difference : differences(before.run, after.run)) {
    if (forgiven) {
      say(stderr, fmt::format("note: compared all the same: {}\n", difference));
    } else {
      problems.push_back({before_name + ", " + after_name, 0, 0, "cannot be compared: " + difference});
    }
  }
  for (const auto& [name, profile] : {std::pair(before_name, &before), {after_name, &after}}) {
    if (profile->repeats < least_repeats_compared) {
      problems.push_back({name, 0, 0,
                          fmt::format("has {}; a comparison needs {} or more (--repeats)",
                                      count_text(profile->repeats, "repeat"), least_repeats_compared)});
    }
  }
  if (!problems.empty()) throw InputError(problems);
  const ZoneComparison comparison = compare_zones(before, after);
  if (request.film.json) {
    say(stdout, comparison_json(comparison));
  } else {
    say(stdout, fmt::format("\n  A {}: {}, supple {}, {}\n  B {}: {}, supple {}, {}\n\n{}", before_name,
                            count_text(before.repeats, "repeat"), before.run.version, before.run.build, after_name,
                            count_text(after.repeats, "repeat"), after.run.version, after.run.build,
                            comparison_text(comparison)));
  }
  return 0;
}

// Returns the command line of one repeat.
std::vector<std::string> one_repeat(const std::string& program, const std::vector<std::string>& command,
                                    const std::filesystem::path& folder) {
  std::vector<std::string> words = {program};
  for (std::size_t i = 1; i < command.size(); ++i) {
    const std::string& word = command[i];
    if (word == "--repeats" || word == "--out" || word == "--against") {
      ++i;
    } else if (!word.starts_with("--repeats=") && !word.starts_with("--out=") && !word.starts_with("--against=") &&
               word != "--json" && word != "--quiet" && word != "--anyway") {
      words.push_back(word);
    }
  }
  // The new words stand after the verb, and before a "--", after which no word is an option.
  words.insert(words.begin() + 2, {"--repeats", "1", "--quiet", "--out=" + folder.string()});
  return words;
}

// Holds the repeats of one program.
struct Profiled {
  std::string program;  // its file
  std::filesystem::path folder;
  std::optional<ZoneProfile> all = {};  // of the repeats so far
};

// Returns the folder for the results: one of its own beside that of the scene's film, where no other is asked for.
std::filesystem::path folder_for(const FilmPlan& plan) {
  const SceneDef scene = Script::load(scene_file(plan.scene), assets_folder(), plan.settings).scene();
  return plan.out.empty() ? std::filesystem::path("out") / (scene.name + "-profile") : std::filesystem::path(plan.out);
}

// Throws InputError where the folder holds a film, which a repeat would replace. An earlier profile may be replaced.
void check_holds_no_film(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder / "run.json", error)) return;
  const auto info = json_object_in<nlohmann::json>(folder / "run.json");
  const bool has_command = info.is_object() && info.contains("command") && info["command"].is_array();
  if (has_command && info["command"].size() > 1 && info["command"][1] == "profile") return;
  throw InputError("--out " + folder.string(), "holds a film, which a profile would remove; name another folder");
}

// Makes one more repeat. Returns the exit status.
int add_repeat(const ProfileCommand& request, const std::vector<std::string>& command, int repeat, Profiled& profiled) {
  const Stopwatch watch;
  const auto end = run_program(one_repeat(profiled.program, command, profiled.folder), interrupted);
  if (!end) throw RunError(profiled.program + ": cannot be started for a repeat");
  const int status = WIFEXITED(end->status) ? WEXITSTATUS(end->status) : interrupted() ? 130 : 1;
  if (status != 0 && status != 130) say(stderr, end->output);
  if (!WIFEXITED(end->status) && !interrupted())
    say(stderr, fmt::format("supple: repeat {} of {} {}; what it left is in {}\n", repeat + 1, request.repeats,
                            how_it_ended(*end), profiled.folder.string()));
  if (status != 0) return status;
  const ZoneProfile one = read_zones(profiled.folder / "zones.json");
  if (profiled.all) add_repeats(one, *profiled.all);
  if (!profiled.all) profiled.all = one;
  if (!request.film.plan.quiet)
    say(stderr, fmt::format("repeat {} of {}: {:.1f} s{}\n", repeat + 1, request.repeats, watch.elapsed_ms() / 1000,
                            request.against.empty() ? "" : ", " + profiled.program));
  return 0;
}

// Returns the programs whose repeats are made in turn: the other one, if any, before this one.
std::vector<Profiled> programs_of(const ProfileCommand& request, const std::filesystem::path& folder) {
  std::vector<Profiled> programs;
  if (!request.against.empty())
    programs.push_back({std::filesystem::absolute(request.against).string(), folder.string() + "-against"});
  programs.push_back({this_program().string(), folder});
  return programs;
}

// Profiles repeats, each in a process of its own, because the place of a process's memory changes the time of a zone by
// more than 10 %, in all of its frames. The repeats before one that fails or is interrupted are reported. Two programs
// run in turn, so that the noise of a shared machine meets both alike, and are compared.
int profile(const ProfileCommand& request, const std::vector<std::string>& command) {
  const std::filesystem::path folder = request.film.plan.out;
  catch_interrupts();
  std::vector<Profiled> programs = programs_of(request, folder);
  for (const Profiled& one : programs) check_holds_no_film(one.folder);
  int status = 0;
  for (int repeat = 0; repeat < request.repeats && status == 0; ++repeat) {
    for (Profiled& one : programs) {
      if (interrupted()) status = 130;
      if (status == 0) status = add_repeat(request, command, repeat, one);
    }
  }
  const Profiled& own = programs.back();
  if (status == 130)
    say(stderr, fmt::format("supple: interrupted; {} of {} repeats are whole\n", own.all ? own.all->repeats : 0,
                            request.repeats));
  for (const Profiled& one : programs) {
    if (one.all) write_whole_file(one.folder / "zones.json", zones_json(*one.all));
  }
  if (request.against.empty() && own.all) report(request, *own.all, folder);
  if (request.against.empty() || status != 0) return status;
  ProfileCommand both = request;
  both.compared = {programs.front().folder.string(), folder.string()};
  return compare(both);
}

int run(const ProfileCommand& request, const std::vector<std::string>& command) {
  if (!request.compared.empty()) return compare(request);
  if (request.film.plan.scene.empty()) throw InputError("profile", "needs a SCENE, or --compare with two zones.json");
  ProfileCommand placed = request;
  placed.film.plan.out = folder_for(request.film.plan).string();
  if (request.repeats > 1 || !request.against.empty()) return profile(placed, command);
  check_holds_no_film(placed.film.plan.out);
  return profile_once(placed, command);
}

// Refuses the options of a run with --compare, which runs nothing.
void check_compare_options(const Verb& verb) {
  for (const std::string& name : verb.given()) {
    if (name != "--compare" && name != "--anyway" && name != "--json" && name != "--quiet")
      throw InputError("profile --compare", name + " has no meaning with it");
  }
}

}  // namespace

void add_profile(CommandLine& line) {
  auto request = std::make_shared<ProfileCommand>();
  Verb verb = line.verb("profile", "Where the time of a scene's frames goes; two profiles compared.");
  verb.footer(
      "Examples: supple profile squirrel --frames 100 --no-images --out out/before\n"
      "          supple profile --compare out/before/zones.json out/after/zones.json\n"
      "          supple profile squirrel --no-images --against ../before/build/release/supple\n"
      "Leaves zones.json, frame-times.svg and trace.json (of the last repeat) beside what render leaves, without a "
      "video.");
  verb.option("SCENE|REPLAY", request->film.plan.scene,
              "scene or replay file, or the name of one that ships (supple list)");
  verb.option("--repeats", request->repeats, "how often the scene is run").between(1, 1000).shows_default();
  verb.option("--compare", request->compared, "two zones.json: what became slower or faster from A to B")
      .two_values("A B");
  verb.flag("--anyway", request->anyway, "compare profiles of different settings, and say how they differ");
  add_film_options(verb, request->film, "out/NAME-profile");
  verb.option("--against", request->against,
              "another supple, such as one built before: both run in turn, and are compared (A is the other one)");
  verb.runs([request, verb, words = line.words()] {
    if (!request->compared.empty()) check_compare_options(verb);
    if (!request->against.empty() && request->repeats < least_repeats_compared)
      throw InputError("--repeats", fmt::format("a comparison needs {} or more", least_repeats_compared));
    std::error_code error;
    if (!request->against.empty() && !std::filesystem::is_regular_file(request->against, error))
      throw InputError("--against " + request->against, "no such program");
    if (request->film.plan.scene == "-")
      throw InputError("profile", "runs a scene several times, so that it needs a file of it");
    return run(*request, words);
  });
}

}  // namespace supple
