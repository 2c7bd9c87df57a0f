#include "app/film_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/film_checks.h"
#include "app/film_identity.h"
#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "base/timing.h"
#include "output/chrome_trace.h"
#include "output/folder_lock.h"
#include "output/run_record.h"
#include "output/whole_file.h"
#include "scene/scene_reader.h"
#include "scene/warnings.h"
#include "base/variants.h"

namespace supple {
namespace {

void print_result(const FilmResult& result, const RunFolder& folder, const SceneDef& scene) {
  say(stdout, fmt::format("\n{}\n", profile_table(result.rows)));
  const double seconds = result.wall_ms / 1000;
  const int made = static_cast<int>(result.rows.size()) - result.kept_frames;
  const std::string kept = result.kept_frames > 0 ? fmt::format(" behind {} from before", result.kept_frames) : "";
  const std::string rate = made > 0 ? fmt::format("{:.1f} a second; ", made / seconds) : "";
  say(stdout, fmt::format("  {} frames{} in {} ({}the film's rate is {:g}), after {} of set-up\n", made, kept,
                          duration_text(seconds), rate, scene.fps, duration_text(result.setup_ms / 1000)));
  if (result.video_written) say(stdout, fmt::format("  film     {}\n", folder.video().string()));
  if (!result.video_message.empty() && !result.video_failed) say(stdout, fmt::format("  {}\n", result.video_message));
  say(stdout, fmt::format("  profile  {}\n", (folder.path() / "profile.json").string()));
}

std::string how_it_ended(const FilmResult& result) {
  return result.end == FilmEnd::done ? "done" : result.end == FilmEnd::interrupted ? "interrupted" : "failed";
}

void print_json(const FilmResult& result, const RunFolder& folder) {
  nlohmann::ordered_json json = {
      {"ended", how_it_ended(result)}, {"message", result.message},
      {"frames", result.rows.size()},  {"wall_ms", result.wall_ms},
      {"setup_ms", result.setup_ms},   {"profile", (folder.path() / "profile.json").string()}};
  json["video"] =
      result.video_written ? nlohmann::ordered_json(folder.video().string()) : nlohmann::ordered_json(nullptr);
  json["video_message"] = result.video_message;
  say(stdout, fmt::format("{}\n", json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)));
}

}  // namespace

std::vector<Problem> all_warnings(const Script& script, const std::vector<Body>& bodies) {
  std::vector<Problem> list = warnings(script.scene(), bodies), of_time = script.warnings();
  list.insert(list.end(), of_time.begin(), of_time.end());
  return list;
}

namespace {

// Warnings, and what reading meshes had to say.
void say_remarks(const Script& script, const std::vector<Body>& bodies) {
  const SceneDef& scene = script.scene();
  if (scene.sweep_points > 0) {
    say(stderr, fmt::format("note: the scene has a sweep of {} points, which this leaves aside: supple sweep runs it\n",
                            scene.sweep_points));
  }
  for (const Problem& warning : all_warnings(script, bodies)) say(stderr, fmt::format("warning: {}\n", warning.text()));
  for (const Body& body : bodies) {
    for (const std::string& note : body.notes) say(stderr, fmt::format("note: {}: {}\n", body.source, note));
  }
  for (const ColliderDef& collider : scene.colliders) {
    for (const std::string& note : collider.shape.notes)
      say(stderr, fmt::format("note: collider '{}': {}\n", collider.name, note));
  }
}

FilmOptions options_of(const FilmRequest& request) {
  FilmOptions film;
  film.threads = request.threads > 0 ? request.threads : std::max(1u, std::thread::hardware_concurrency());
  film.error_every = request.error_every;
  film.fields_every = request.fields_every;
  film.save_states = request.save_states;
  film.images = !request.no_images;
  film.video = !request.no_video;
  film.gl = *value_named<GlChoice>(request.gl);
  film.quiet = request.quiet;
  film.shaders = shaders_folder();
  film.font = caption_font();
  return film;
}

bool remembers_steps(const SceneDef& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const BodyDef& body) { return remembers_steps(body.solver.method); });
}

bool remembers_steps(const Script& script) {
  for (int frame = 0; frame < script.scene().frames; ++frame) {
    const std::vector<const TimedChange*> at_work = script.at_work(frame);
    const bool method = std::any_of(at_work.begin(), at_work.end(), [](const TimedChange* c) { return c->cost.rule; });
    if (method && remembers_steps(script.scene_at(frame))) return true;
  }
  return remembers_steps(script.scene());
}

void add_result(const FilmResult& result, RunInfo& info) {
  info.gl_backend = result.gl_backend;
  info.gl_renderer = result.gl_renderer;
  info.gl_version = result.gl_version;
  info.frames = static_cast<int>(result.rows.size());
  info.ended = how_it_ended(result);
  if (result.end == FilmEnd::failed) info.ended += ": " + result.message;
  info.video = result.video_written ? "video.mp4" : result.video_message;
}

// Returns the exit status.
int say_result(const FilmRequest& request, const FilmResult& result, const RunFolder& folder, const SceneDef& scene,
               const std::string& unrecorded) {
  if (request.json) {
    print_json(result, folder);
  } else if (request.table && !request.quiet && !result.rows.empty()) {
    print_result(result, folder, scene);
  }
  if (result.end == FilmEnd::failed) {
    say(stderr, fmt::format("supple: {}\n  kept: {} whole frames in {}\n", result.message,
                            std::max(int(result.rows.size()), result.kept_frames), folder.path().string()));
  }
  if (!unrecorded.empty()) say(stderr, fmt::format("supple: {}\n", unrecorded));
  if (result.video_failed) say(stderr, fmt::format("supple: {}\n", result.video_message));
  if (result.end == FilmEnd::interrupted) {
    say(stderr, fmt::format("supple: interrupted after {} frames; they are whole, and so is what belongs to them in "
                            "{}{}\n",
                            result.rows.size(), folder.path().string(),
                            std::filesystem::exists(folder.checkpoint()) ? "; --resume goes on" : ""));
    return 130;
  }
  return result.end == FilmEnd::done && !result.video_failed && unrecorded.empty() ? 0 : 1;
}

}  // namespace

namespace {

// Of the changes at work, the one that a body's model must follow; null where there are several.
const TimedChange* only_change(const std::vector<const TimedChange*>& at_work, const std::string& body) {
  const TimedChange* only = nullptr;
  for (const TimedChange* change : at_work) {
    if (!change->cost.factor || (!change->object.empty() && change->object != body)) continue;
    if (only != nullptr) return nullptr;
    only = change;
  }
  return only;
}

}  // namespace

void try_changes(const Script& script, std::vector<Body> bodies) {
  std::vector<Problem> problems;
  const auto tell = [&problems](Problem problem) {
    const auto same = [&problem](const Problem& p) { return p.text() == problem.text(); };
    if (std::none_of(problems.begin(), problems.end(), same)) problems.push_back(std::move(problem));
  };
  for (int frame = 0; frame < script.scene().frames; ++frame) {
    const std::vector<const TimedChange*> at_work = script.at_work(frame);
    if (std::none_of(at_work.begin(), at_work.end(), [](const TimedChange* change) { return change->cost.factor; }))
      continue;
    const SceneDef scene = script.scene_at(frame);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      try {
        update_body(bodies[b], scene, scene.bodies[b]);
      } catch (const InputError& error) {
        const TimedChange* change = only_change(at_work, scene.bodies[b].name);
        for (const Problem& problem : error.problems()) {
          const Problem& place = change != nullptr ? change->place : problem;
          tell({place.source, place.line, place.column, problem.message});
        }
        bodies[b].def = scene.bodies[b];  // what comes later is its own fault
      }
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

void add_film_options(CLI::App& verb, FilmRequest& request) {
  verb.add_option("--out", request.out, "folder for the results [out/NAME]");
  verb.add_option("--frames", request.frames, "length of the film, over the scene's")->check(CLI::Range(1, 1000000));
  verb.add_option("--threads", request.threads, "threads of the solver [all cores]; results do not depend on it")
      ->check(CLI::Range(1, 256));
  verb.add_option("--set", request.set, "path=value over the scene's, such as solver.iterations=20; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  verb.add_option("--seed", request.seed, "of random start states, over the scene's")->check(CLI::Range(0, 2000000000));
  verb.add_option("--error-every", request.error_every, "measure the error of equation 12 every N frames (slow)")
      ->check(CLI::Range(1, 1000000));
  verb.add_option("--save-state", request.save_states,
                  "frames, such as 10,20: each body's state and problem before it, in states/BODY-NNNNNN/")
      ->delimiter(',')
      ->take_all()
      ->allow_extra_args(false)
      ->check(CLI::Range(0, 999999));
  verb.add_option("--vtu", request.fields_every,
                  "write fields every N frames, for ParaView: fields/BODY-NNNNNN.vtu and fields/BODY.pvd")
      ->check(CLI::Range(1, 1000000));
  verb.add_flag("--no-video", request.no_video, "frames only");
  verb.add_flag("--no-images", request.no_images, "simulate only");
  verb.add_flag("--trace", request.trace,
                "where every thread's time went, for chrome://tracing or Perfetto: trace.json");
  verb.add_option("--gl", request.gl, word_list(all_names<GlChoice>()))->check(CLI::IsMember(all_names<GlChoice>()));
  verb.add_option("--checkpoint-every", request.checkpoint_every,
                  "frames between checkpoints, from which a film can be resumed; 0 makes none")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  verb.add_option("--record", request.record, "file for the states of all frames, to be compared with --verify");
  CLI::Option* verify =
      verb.add_option("--verify", request.verify, "stop at the first frame that is not as this file has it");
  verb.add_option("--tolerance", request.tolerance,
                  "compare positions up to this, over the body's size, instead of all bits")
      ->needs(verify)
      ->check(CLI::Range(0.0, 1.0));
  verb.add_flag("--quiet", request.quiet, "say nothing but errors");
  verb.add_flag("--json", request.json, "the result as one line of JSON on standard output");
}

void add_film(CLI::App& verb, const FilmArgument& argument, Action& action, const std::vector<std::string>& command) {
  auto request = std::make_shared<FilmRequest>();
  verb.add_option(argument.name, request->scene, argument.meaning)->required();
  add_film_options(verb, *request);
  verb.add_flag("--resume", request->resume, "go on with the film in --out that was interrupted or killed");
  verb.callback([&action, request, command] { action = [request, command] { return run_film(*request, command); }; });
}

namespace {

// Where the film in a folder was gone on with before.
std::vector<int> resumed_before(const std::filesystem::path& run) {
  const nlohmann::ordered_json info = read_run(run).info;
  return info.contains("resumed_at") ? info["resumed_at"].get<std::vector<int>>() : std::vector<int>();
}

}  // namespace

int run_film(const FilmRequest& request, const std::vector<std::string>& command, FilmRecord* record) {
  name_thread("main");
  if (request.trace) start_trace();
  Zone zone("read scene");
  const Stopwatch setup;
  RunInfo info;
  info.command = command;
  info.scene_file = scene_file(request.scene).string();
  std::vector<std::string> settings = request.set;
  if (request.frames > 0) settings.push_back(fmt::format("frames={}", request.frames));
  if (request.seed >= 0) settings.push_back(fmt::format("seed={}", request.seed));
  const Script script = Script::load(info.scene_file, assets_folder(), settings, request.sweep_point);
  const SceneDef& scene = script.scene();
  info.scene_json = script.scene_json();
  info.replay_json = script.replay_json();
  check_save_states(request.save_states, scene, {}, 0);
  zone.next("assemble meshes");
  std::vector<Body> bodies = assemble(scene);
  if (!request.quiet) say_remarks(script, bodies);
  try_changes(script, bodies);
  zone.next("build models");
  std::vector<Model> models;
  for (const Body& body : bodies) models.push_back(build_model(body.description));

  zone.next("begin folder");
  FilmOptions options = options_of(request);
  if (request.last_image_only) options.pictured = {scene.frames - 1};
  info.kernel_variant = variant_name(best_variant());
  info.threads = options.threads;
  for (const Body& body : bodies) {
    const TetMesh& mesh = body.description.mesh;
    const auto elements = static_cast<int>(mesh.tets.rows() + body.description.springs.size());
    info.meshes.push_back({body.def.name, body.source, mesh_hash(body), int(mesh.rest.rows()), elements});
    if (!request.quiet)
      say(stderr,
          fmt::format("{}: {} vertices, {} elements ({})\n", body.def.name, mesh.rest.rows(), elements, body.source));
  }
  const std::filesystem::path path =
      request.out.empty() ? std::filesystem::path("out") / scene.name : std::filesystem::path(request.out);
  options.identity = identity_of(info, script, bodies, request);
  options.checkpoint_every = remembers_steps(script) ? 0 : request.checkpoint_every;
  std::error_code ignored;
  std::optional<FolderLock> lock;
  if (!request.folder_is_held && std::filesystem::is_directory(path, ignored)) lock.emplace(path);
  if (request.resume) options.start = checkpoint_in(path, options.identity, scene.frames, info);
  const int start = options.start ? options.start->frames : 0;
  check_save_states(request.save_states, scene, path, start);
  check_rows_and_motion(path, bodies, static_cast<int>(scene.colliders.size()), start);
  if (options.images && !request.last_image_only) check_pictures(path / "frames", start);
  options.record = request.record;
  options.record_head = record_head(info, bodies);
  if (!request.record.empty()) check_record(request.record, path, options.record_head, start);
  if (!request.record.empty() && !request.verify.empty() &&
      (request.record == request.verify || std::filesystem::equivalent(request.record, request.verify, ignored)))
    throw InputError("--record " + request.record, "is the file to --verify with, which would be overwritten");
  std::optional<StateVerifier> verifier;
  if (!request.verify.empty()) {
    verifier.emplace(request.verify, options.record_head, request.tolerance, start);
    if (!verifier->remark().empty()) say(stderr, fmt::format("note: {}: {}\n", request.verify, verifier->remark()));
    options.verifier = &*verifier;
  }
  if (!request.folder_is_held && !lock) lock.emplace(path);  // not before all that is refused without a trace
  const RunFolder folder(path, start);
  info.ended = "running";
  if (start > 0) info.resumed = resumed_before(path);
  if (start > 0) info.resumed.push_back(start);
  folder.write_info(info);

  zone.finish();
  catch_interrupts();
  const double before_film = setup.elapsed_ms();
  FilmResult result = make_film(script, bodies, models, folder, options);
  result.setup_ms += before_film;

  add_result(result, info);
  std::vector<ThreadTrace> trace = request.trace ? stop_trace() : std::vector<ThreadTrace>();
  std::string unrecorded;  // what the disk refused; said after what went wrong first
  try {
    folder.write_info(info);
    folder.write_profile(profile_json(result.rows));
    if (request.trace) write_whole_file(folder.trace(), chrome_trace(trace));
  } catch (const RunError& error) {
    unrecorded = error.what();
  }
  int status = say_result(request, result, folder, scene, unrecorded);
  if (verifier && result.end == FilmEnd::done) {
    const int frames = static_cast<int>(result.rows.size());
    const bool compared = verifier->compared_any(frames);
    say(request.json || !compared ? stderr : stdout, fmt::format("  {}\n", verifier->verdict(frames)));
    if (!compared) status = 1;
  }
  if (record != nullptr) *record = {info, folder.path(), scene.name, scene.fps, result, std::move(trace)};
  return status;
}

}  // namespace supple
