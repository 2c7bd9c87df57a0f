#include "app/film_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/solvers.h"
#include "base/console.h"
#include "base/error.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "base/timing.h"
#include "film/earlier_run.h"
#include "film/pictures/picture_words.h"
#include "film/plan/film_coding.h"
#include "film/plan/shipped_files.h"
#include "film/rough_motion.h"
#include "output/files/json_text.h"
#include "output/files/whole_file.h"
#include "output/pages/run_page.h"
#include "output/run/run_record.h"
#include "scene/reading/model_scene.h"
#include "scene/replay/script_trial.h"

namespace supple {

void say_remarks(const FilmPlan& plan, const LoadedFilm& film) {
  const SceneDef& scene = film.world.script().scene();
  if (scene.sweep_points > 0) {
    say(stderr, fmt::format("note: the scene has a sweep of {} points, which this leaves aside: supple sweep runs it\n",
                            scene.sweep_points));
  }
  for (const Problem& warning : said(all_warnings(film.world.script(), film.world.bodies())))
    say(stderr, fmt::format("warning: {}\n", warning.text()));
  if (const auto letters = letters_warning(film.world.script(), text_font(scene.text));
      letters && plan.pictures != FilmPictures::none)
    say(stderr, fmt::format("warning: {}\n", letters->text()));
  for (const Body& body : film.world.bodies()) {
    for (const std::string& note : body.notes) say(stderr, fmt::format("note: {}: {}\n", body.source, note));
  }
  for (const ColliderDef& collider : scene.colliders) {
    for (const std::string& note : collider.shape.notes)
      say(stderr, fmt::format("note: collider '{}': {}\n", collider.name, note));
  }
}

void go_on(const FilmPlan& plan, LoadedFilm& film) {
  for (const std::string& note : go_on_from_run(plan, all_solvers().steps, film.world))
    if (!plan.quiet) say(stderr, fmt::format("note: {}\n", note));
}

namespace {

void say_bodies(const RunInfo& info) {
  for (const RunInfo::Mesh& mesh : info.meshes)
    say(stderr,
        fmt::format("{}: {} vertices, {} elements ({})\n", mesh.body, mesh.vertices, mesh.elements, mesh.source));
}

// Says into which folder the run goes where a user may expect another one. Where it is not the folder that was asked
// for, this is said with --quiet too.
void say_place(const FilmPlan& plan, const RunPlace& place) {
  if (!place.note.empty() && (!plan.quiet || !place.is_as_asked)) say(stderr, fmt::format("note: {}\n", place.note));
}

// Warns of what the film's format cannot hold: with --quiet too, because this concerns what the film shows.
void say_coding(const FilmPlan& plan, const SceneDef& scene) {
  if (!plan.wants_video()) return;
  for (const std::string& warning :
       coding_warnings(coding_for(plan.coding, scene), scene.fps.over(plan.pictures_every())))
    say(stderr, fmt::format("warning: {}\n", warning));
}

// Tells what a preview leaves out.
void say_preview(const LoadedFilm& film) {
  const SceneDef& scene = film.world.script().scene();
  std::string meshes;
  for (const RunInfo::Mesh& mesh : film.info.meshes)
    meshes += fmt::format("{}'{}' has {} vertices", meshes.empty() ? "" : ", ", mesh.body, mesh.vertices);
  say(stderr,
      fmt::format("preview: {} x {} pixels, every other frame; {}\n", scene.output.width, scene.output.height, meshes));
}

void print_result(const FilmResult& result, const RunFolder& folder, const SceneDef& scene) {
  say(stdout, fmt::format("\n{}\n", result.tally.table()));
  const double seconds = result.wall_ms / 1000;
  const int made = result.rows.size() - result.kept_frames;
  const std::string kept = result.kept_frames > 0 ? fmt::format(" after {} from before", result.kept_frames) : "";
  const std::string rate = made > 0 ? fmt::format("{:.1f} a second; ", made / seconds) : "";
  say(stdout, fmt::format("  {}{} in {} ({}the film's rate is {}), after {} of set-up\n", count_text(made, "frame"),
                          kept, duration_text(seconds), rate, scene.fps.text(), duration_text(result.setup_ms / 1000)));
  if (const std::string played = result.tally.session_text(); !played.empty())
    say(stdout, fmt::format("  session  {}\n", played));
  if (result.video_written) say(stdout, fmt::format("  film     {}\n", result.video.string()));
  for (const std::filesystem::path& still : result.stills)
    say(stdout, fmt::format("  {:<8} {}\n", still.stem().string(), still.string()));
  say(stdout, fmt::format("  profile  {}\n", (folder.path() / "profile.json").string()));
  const bool too_slow = made > 0 && made / seconds < scene.fps;  // only then is it worth saying what helps
  if (too_slow) say(stdout, fmt::format("  {}\n", verdict_on(result)));
}

void print_json(const FilmResult& result, const RunFolder& folder) {
  nlohmann::ordered_json json = {{"ended", text_of(result.end)},
                                 {"message", result.message},
                                 {"frames", result.rows.size()},
                                 {"wall_ms", result.wall_ms},
                                 {"setup_ms", result.setup_ms},
                                 {"folder", folder.path().string()},
                                 {"profile", (folder.path() / "profile.json").string()}};
  json["video"] =
      result.video_written ? nlohmann::ordered_json(result.video.string()) : nlohmann::ordered_json(nullptr);
  json["video_message"] = result.video_message;
  json["verdict"] = verdict_on(result);
  json["warnings"] = result.tally.remarks();
  for (std::string& warning : result.tally.warnings()) json["warnings"].push_back(std::move(warning));
  say(stdout, fmt::format("{}\n", json_text(json)));
}

struct EndOfRun {
  const FilmResult& result;
  const RunFolder& folder;
  const RunPlace& place;
  const SceneDef& scene;
  std::string unrecorded;  // the message of a final record that could not be written
};

// Returns how an interrupted film is resumed; empty where it cannot be. A numbered folder must be named.
std::string resuming_text(const EndOfRun& end) {
  if (!std::filesystem::exists(end.folder.checkpoint())) return "";
  if (end.place.is_as_asked) return "; --resume goes on";
  return fmt::format("; --resume --out {} goes on", shell_word(end.folder.path().string()));
}

// Prints how the film ended; returns the exit status.
int say_result(const FilmCommand& command, const EndOfRun& end) {
  const auto& [result, folder, place, scene, unrecorded] = end;
  if (command.json) {
    print_json(result, folder);
  } else if (command.table && !command.plan.quiet && !result.rows.empty()) {
    print_result(result, folder, scene);
  }
  for (const std::string& warning : result.tally.warnings()) say(stderr, fmt::format("warning: {}\n", warning));
  if (result.end == FilmEnd::failed) {
    say(stderr, fmt::format("supple: {}\n  kept: {} {} in {}\n", result.message,
                            std::max(result.rows.size(), result.kept_frames),
                            command.plan.film_only ? "frames' motion" : "whole frames", folder.path().string()));
  }
  if (!unrecorded.empty()) say(stderr, fmt::format("supple: {}\n", unrecorded));
  if (!result.video_message.empty())
    say(stderr, fmt::format("{}: {}\n", result.video_failed ? "supple" : "warning", result.video_message));
  if (!result.stills_message.empty()) say(stderr, fmt::format("supple: {}\n", result.stills_message));
  if (result.end == FilmEnd::interrupted) {
    say(stderr, fmt::format("supple: interrupted after {}; they are whole, and so is what belongs to them in {}{}\n",
                            count_text(long(result.rows.size()), "frame"), folder.path().string(), resuming_text(end)));
    return 130;
  }
  const bool all_written = !result.video_failed && unrecorded.empty() && result.stills_message.empty();
  return result.end == FilmEnd::done && all_written ? 0 : 1;
}

// Prints the result of the comparison with a record. Returns false when there was nothing to compare.
bool say_verdict(const FilmCommand& command, const StateVerifier& verifier, int frames) {
  const bool compared = verifier.compared_any(frames);
  say(command.json || !compared ? stderr : stdout, fmt::format("  {}\n", verifier.verdict(frames)));
  return compared;
}

}  // namespace

void add_film_options(Verb& verb, FilmCommand& command, const std::string& folder) {
  FilmPlan& plan = command.plan;
  verb.option("--out", plan.out, "folder for the results [" + folder + "]");
  add_size_option(verb, plan.size, "the scene's");
  verb.option("--frames", plan.frames, "length of the film, over the scene's").between(1, 1000000);
  const auto take_from = [&plan](const std::string& run) {
    if (run.empty()) throw InputError("--from", "names no folder");  // as by a shell's variable that is not set
    plan.from = run;
  };
  const Option from = verb.option("--from", take_from,
                                  "folder of an earlier run: bodies of the same name go on from where they were there");
  verb.option("--frame", plan.from_frame, "of that run, counted from 0 [its last]").needs(from).between(0, 1000000);
  verb.option("--threads", plan.threads, "threads of the solver [all cores]; results do not depend on it")
      .between(1, 256);
  verb.option("--set", plan.settings, "path=value over the scene's, such as solver.iterations=20; may be repeated")
      .repeatable();
  verb.option("--seed", plan.seed, "of random start states, over the scene's").between(0, 2000000000);
  verb.option("--error-every", plan.error_every, "measure the error of equation 12 every N frames (slow)")
      .between(1, 1000000);
  verb.option("--save-state", plan.save_states,
              "frames, such as 10,20: each body's state and problem before it, in states/BODY-NNNNNN/")
      .separated_by(',')
      .repeatable()
      .between(0, 999999);
  verb.option("--vtu", plan.fields_every,
              "write fields every N frames, for ParaView: fields/BODY-NNNNNN.vtu and fields/BODY.pvd")
      .between(1, 1000000);
  verb.flag(
      "--no-video", [&plan] { plan.video = false; }, "frames only");
  verb.flag(
      "--no-images", [&plan] { plan.pictures = FilmPictures::none; }, "simulate only");
  verb.flag("--trace", plan.trace, "where every thread's time went, for chrome://tracing or Perfetto: trace.json");
  add_gl_option(verb, plan.gl);
  verb.option("--checkpoint-every", plan.checkpoint_every,
              "frames between checkpoints, from which a film can be resumed; 0 makes none")
      .between(0, 1000000)
      .shows_default();
  verb.option("--record", plan.record, "file for the states of all frames, to be compared with --verify");
  const Option verify = verb.option("--verify", plan.verify, "stop at the first frame that is not as this file has it");
  verb.option("--tolerance", plan.tolerance, "compare positions up to this, over the body's size, instead of all bits")
      .needs(verify)
      .between(0.0, 1.0);
  verb.option("--repeat", plan.repeat,
              "folder of an earlier run of a scene with solver.budget_ms: end each step after as many iterations as "
              "there, for the same bits");
  add_cache_option(verb, plan.cache);
  verb.flag("--quiet", plan.quiet, "say nothing but errors, and warnings of what the film shows");
  verb.flag("--json", command.json, "the result as one line of JSON on standard output");
}

void add_gl_option(Verb& verb, GlChoice& gl) {
  verb.option(
          "--gl", [&gl](const std::string& word) { gl = *value_named<GlChoice>(word); },
          word_list(all_names<GlChoice>()))
      .one_of(all_names<GlChoice>());
}

void add_size_option(Verb& verb, std::string& size, const std::string& usual) {
  verb.option("--size", size,
              "of the pictures: portrait, square, 720p, 1080p, 4k or WIDTHxHEIGHT; the camera frames the bodies for "
              "it [" +
                  usual + "]");
}

void add_cache_option(Verb& verb, bool& cache) {
  verb.flag(
      "--no-cache", [&cache] { cache = false; }, "make meshes and skins again; keep none in the user's cache folder");
}

void add_coding_options(Verb& verb, FilmCoding& coding) {
  verb.option(
          "--format", [&coding](const std::string& word) { coding.format = *value_named<FilmFormat>(word); },
          "of the film [mp4, and webm of a transparent one]: " + word_list(all_names<FilmFormat>()) +
              "; png makes pictures alone")
      .one_of(all_names<FilmFormat>());
  verb.option(
          "--quality", [&coding](const std::string& word) { coding.quality = *value_named<FilmQuality>(word); },
          "of the film [good]: " + word_list(all_names<FilmQuality>()))
      .one_of(all_names<FilmQuality>());
}

void add_passes_option(Verb& verb, std::vector<std::string>& passes) {
  verb.option("--passes", passes,
              "pictures in numbers for compositors, such as depth,masks: " + word_list(all_names<PicturePass>()))
      .separated_by(',')
      .repeatable()
      .one_of(all_names<PicturePass>());
}

void ask_for_passes(const std::vector<std::string>& passes, std::vector<std::string>& settings) {
  if (!passes.empty())
    settings.insert(settings.begin(), fmt::format("output.passes=[\"{}\"]", fmt::join(passes, "\", \"")));
}

SceneSource opened_scene(const std::string& name, const std::vector<std::string>& settings, bool quiet) {
  SceneSource source = scene_source(name);
  if (source.text || !is_model(source.path)) return source;
  ModelScene scene = model_scene(source.path, wish_of(settings));
  for (const std::string& note : scene.notes_with(settings))
    if (!quiet) say(stderr, fmt::format("note: {}: {}\n", source.path.string(), note));
  source.text = std::move(scene.text);
  return source;
}

void take_scene(FilmPlan& plan) {
  SceneSource source = opened_scene(plan.scene, plan.settings, plan.quiet);
  if (!source.text) return;
  plan.scene = source.path.string();
  plan.scene_text = std::move(source.text);
}

void add_film(Verb& verb, const FilmArgument& argument, const std::vector<std::string>& words) {
  auto command = std::make_shared<FilmCommand>();
  verb.option(argument.name, command->plan.scene, argument.meaning).required();
  add_film_options(verb, *command, "out/NAME");
  FilmPlan& plan = command->plan;
  plan.stills = true;
  plan.force = false;
  verb.flag("--resume", plan.resume, "go on with the film in --out that was interrupted or killed");
  verb.flag("--force", plan.force, "overwrite another run in the folder; without it a numbered folder is taken");
  verb.flag("--preview", plan.preview,
            "a first look: small pictures of every other frame, coarse meshes, into out/NAME-preview")
      .excludes({"--resume", "--checkpoint-every"});
  add_coding_options(verb, plan.coding);
  add_passes_option(verb, command->passes);
  verb.flag(
      "--no-stills", [&plan] { plan.stills = false; }, "no poster.png and no sheet.png");
  verb.flag("--page", command->page, "also one HTML page of the run: index.html, as supple page makes it");
  verb.flag("--film-only", plan.film_only,
            "leave the film and no files of its frames; without those there are no checkpoints, so that --resume "
            "starts anew after a run that was killed")
      .excludes({"--no-video", "--no-images", "--checkpoint-every"});
  verb.runs([command, words] {
    take_scene(command->plan);
    ask_for_passes(command->passes, command->plan.settings);
    return run_film(*command, words);
  });
}

int run_film(const FilmCommand& command, const std::vector<std::string>& words, FilmRecord* record) {
  const FilmPlan& plan = command.plan;
  name_thread("main");
  if (plan.trace) start_trace();
  const Stopwatch setup;
  LoadedFilm film = load_film(plan, words);
  const SceneDef& scene = film.world.script().scene();
  catch_interrupts();
  go_on(plan, film);
  if (!plan.quiet) say_remarks(plan, film);
  build_models(plan, film);
  if (!plan.quiet) say_bodies(film.info);
  if (!plan.quiet && plan.preview) say_preview(film);
  FilmStart start = check_film(plan, film);
  if (start.verifier && !start.verifier->remark().empty())
    say(stderr, fmt::format("note: {}: {}\n", plan.verify, start.verifier->remark()));
  say_place(plan, start.place);
  say_coding(plan, scene);
  const std::string framing = find_framing(plan, start, all_solvers(), film);
  if (!plan.quiet && !framing.empty()) say(stderr, framing);
  const RunFolder folder = open_folder(start, film);
  if (!plan.quiet && plan.pictures == FilmPictures::all && !plan.film_only)
    say(stderr, fmt::format("frames appear in {}\n", folder.frames().string()));

  const double before_film = setup.elapsed_ms();
  FilmResult result = make_film(plan, film, start, folder, all_solvers());
  result.setup_ms += before_film;

  std::vector<ThreadTrace> trace = plan.trace ? stop_trace() : std::vector<ThreadTrace>();
  const std::string unrecorded = write_records(result, film, folder, plan.trace ? &trace : nullptr);
  int status = say_result(command, {result, folder, start.place, scene, unrecorded});
  if (start.verifier && result.end == FilmEnd::done && !say_verdict(command, *start.verifier, result.rows.size()))
    status = 1;
  if (command.page && !result.rows.empty()) {
    const std::filesystem::path page = folder.path() / "index.html";
    write_whole_file(page, run_page(read_run(folder.path())));
    if (!plan.quiet && !command.json) say(stdout, fmt::format("  page     {}\n", page.string()));
  }
  if (record != nullptr) *record = {film.info, folder.path(), scene.name, scene.fps, result, std::move(trace)};
  return status;
}

}  // namespace supple
