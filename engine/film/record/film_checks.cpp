#include "film/record/film_checks.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/console.h"
#include "base/error.h"
#include "film/record/film_log.h"
#include "output/files/json_text.h"
#include "output/files/png_file.h"
#include "output/motion/force_file.h"
#include "output/motion/point_cache.h"
#include "output/motion/pose_table.h"
#include "output/run/json_difference.h"
#include "scene/definition/scene_def.h"

namespace supple {

using Json = nlohmann::ordered_json;

namespace {

// Returns all that two runs must have in common for one to count as the beginning of the other, where no checkpoint
// tells more.
std::string film_of_run(const Json& run) {
  Json film = {{"program", run.value("program", Json())}, {"scene", run.value("scene", Json())}};
  if (film["scene"].is_object()) film["scene"].erase("frames");
  if (run.contains("replay")) film["replay"] = run["replay"];
  for (const Json& mesh : run.value("meshes", Json::array()))
    film["meshes"][mesh.at("body").get<std::string>()] = mesh.at("xxh64");
  return exact_json_text(film);
}

// Tells whether a run has only just begun to use the folder. Everything else in the folder then comes from an earlier
// run.
bool has_just_begun(const std::filesystem::path& run) {
  const auto json = json_object_in<Json>(run / "run.json");
  return json.is_object() && !json.contains("ended");
}

// Refuses a folder without a checkpoint that holds more than the beginning of this same film: the film would be made
// again from its start.
void check_nothing_is_lost(const std::filesystem::path& run, const RunInfo& info) {
  const std::filesystem::path file = run / "run.json";
  if (!std::ifstream(file)) return;
  const auto before = json_object_in<Json>(file);
  const auto refuse = [&run](const std::string& what) {
    throw InputError("--resume", fmt::format("{} holds {}; without --resume it is made anew", run.string(), what));
  };
  try {
    if (before.at("ended") == "done")
      refuse(fmt::format("a film that is complete, of {} frames, and no checkpoint to go on from",
                         before.at("frames").get<int>()));
    const std::vector<std::string> differences =
        json_differences(film_of_run(before), film_of_run(parsed_json<Json>(info_json(info))));
    std::string list;
    for (const std::string& difference : differences) list += "\n  " + difference;
    if (!list.empty()) refuse(fmt::format("another film than this one and no checkpoint; then and now:{}\n", list));
  } catch (const Json::exception&) {
    throw InputError(file.string(), "is damaged; without --resume the film is made anew");
  }
}

}  // namespace

std::optional<WorldState> checkpoint_in(const std::filesystem::path& run, const std::string& identity, int frames,
                                        const RunInfo& info) {
  const std::filesystem::path file = RunFolder::checkpoint_of(run);
  std::error_code error;
  const bool begun = has_just_begun(run);
  if (begun || !std::filesystem::exists(file, error)) {
    if (!begun) check_nothing_is_lost(run, info);
    say(stderr, fmt::format("note: {} has no checkpoint yet; starting with the first frame\n", run.string()));
    return std::nullopt;
  }
  WorldState checkpoint = read_checkpoint(file, identity);
  if (checkpoint.frames > frames)
    throw InputError("--resume", fmt::format("the film in {} has {} frames already, which is more than {}",
                                             run.string(), checkpoint.frames, frames));
  say(stderr, fmt::format("note: resuming after frame {} of {}\n", checkpoint.frames, frames));
  return checkpoint;
}

void check_rows_and_motion(const std::filesystem::path& run, const std::vector<Body>& bodies, const SceneDef& scene,
                           int frames) {
  if (frames == 0) return;
  noted_rows(RunFolder::checkpoint_of(run).parent_path() / "rows.jsonl", frames);
  const auto refuse = [frames](const std::filesystem::path& file) {
    throw InputError(file.string(),
                     fmt::format("does not have the {} frames to go on from; start anew without --resume", frames));
  };
  for (const Body& body : bodies) {
    const std::filesystem::path motion = run / "motion" / (body.def.name + ".pc2");
    const auto vertices = static_cast<int>(body.description.mesh.rest.rows());
    if (!point_cache_has(motion, vertices, frames)) refuse(motion);
    const std::filesystem::path forces = run / "motion" / (body.def.name + ".forces");
    if (scene.may_touch() && !force_file_has(forces, vertices, frames)) refuse(forces);
  }
  const std::filesystem::path table = run / "motion" / "colliders.csv";
  const int poses = static_cast<int>(scene.colliders.size()) * frames;
  if (poses > 0 && !pose_table_bytes(table, poses)) refuse(table);
}

void check_pictures(const std::filesystem::path& frames, int count) {
  for (int frame = 0; frame < count; ++frame) {
    const std::filesystem::path picture = picture_file(frames, frame);
    if (!looks_whole(picture))
      throw InputError(picture.string(),
                       "is missing or damaged, and --resume does not make it again; start anew without --resume");
  }
}

void check_kept_passes(const std::filesystem::path& passes, const SceneDef& scene, int count) {
  const auto check = [&passes](PicturePass pass, const std::string& mesh, int frame) {
    const std::filesystem::path file = pass_file(passes, pass, mesh, frame);
    std::error_code error;
    if (!std::filesystem::exists(file, error))
      throw InputError(file.string(), "is missing, and --resume does not make it again; start anew without --resume");
  };
  for (int frame = 0; frame < count; ++frame) {
    for (const PicturePass pass : scene.output.passes) {
      if (pass != PicturePass::masks) check(pass, "", frame);
      for (const BodyDef& body : scene.bodies)
        if (pass == PicturePass::masks) check(pass, body.name, frame);
    }
  }
}

void note_other_graphs(const SceneDef& scene, const std::filesystem::path& run, int kept_frames) {
  if (kept_frames == 0 || !scene.text.error_graph) return;
  const auto before = json_object_in<Json>(run / "run.json");
  if (!before.is_object() || !before.contains("scene") || !before["scene"].is_object()) return;
  const Json then = before["scene"].value("frames", Json(SceneDef{}.frames));
  if (then == scene.frames) return;
  say(stderr, fmt::format("note: the graphs in the first {} pictures are {} frames long, as the film was then, and in "
                          "the others {}; supple draw {} makes all alike\n",
                          kept_frames, then.dump(), scene.frames, run.string()));
}

namespace {

// Returns the path without links, without "..", and without a slash at the end.
std::filesystem::path full_path(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::weakly_canonical((std::filesystem::absolute(path) / "").lexically_normal().parent_path(),
                                           error);
}

// Tells whether a run keeps, or may keep, a file of its own at this path.
bool is_of_run(const std::filesystem::path& file, const std::filesystem::path& run) {
  const std::filesystem::path inside = full_path(file).lexically_relative(full_path(run));
  if (inside.empty()) return false;
  const std::string first = inside.begin()->string();
  for (const char* own :
       {"frames", "passes", "motion", "states", "fields", "checkpoint", "run.json", "profile.json", "trace.json",
        "video.mp4", "video.webm", "video.mov", "video.gif", "poster.png", "sheet.png", "index.html"}) {
    if (first == own || first == std::string(own) + ".part") return true;
  }
  return false;
}

// Throws InputError when the file cannot be opened for writing. A file that did not exist before is removed again.
void try_to_write(const std::filesystem::path& path) {
  std::error_code error;
  const bool was_there = std::filesystem::exists(std::filesystem::symlink_status(path, error));
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
  if (file < 0)
    throw InputError("--record " + path.string(), fmt::format("cannot be written: {}", std::strerror(errno)));
  ::close(file);
  if (!was_there) std::filesystem::remove(path, error);
}

}  // namespace

void check_record(const std::filesystem::path& record, const std::filesystem::path& run, const RecordHead& head,
                  int kept_frames) {
  std::error_code error;
  const std::string source = "--record " + record.string();
  if (std::filesystem::exists(record, error) && !std::filesystem::is_regular_file(record, error))
    throw InputError(source, "is not a file");
  if (is_of_run(record, run))
    throw InputError(source,
                     fmt::format("is where the run keeps its own files in {}; choose another place", run.string()));
  if (!may_be_recorded_over(record))
    throw InputError(source, "is there already and not a record, so it is not written over; choose another name");
  if (kept_frames > 0) check_kept_record(record, head, kept_frames);
  const bool in_new_folder = !std::filesystem::exists(run, error) && full_path(record).parent_path() == full_path(run);
  if (!in_new_folder) try_to_write(record);  // a new folder is the run's to make
}

}  // namespace supple
