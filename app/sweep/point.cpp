#include "app/sweep/point.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "app/film_run.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/timing.h"
#include "film/plan/shipped_files.h"
#include "output/files/folder_lock.h"
#include "output/files/json_text.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

// Returns the program and the scene that a record is made with; the scene's hash is empty where the point's scene
// cannot be read.
Json made_with(const SweepRequest& request, std::size_t point) {
  std::string scene;
  try {
    scene = hash_text_form(
        hash_text(sweep_point_json(request.file, assets_folder(), request.settings, request.sweep, point)));
  } catch (const InputError&) {
    scene = "";
  }
  return {{"program", hash_text_form(program_identity())}, {"scene", scene}};
}

std::vector<std::string> paths_of(const SweepDef& sweep) {
  std::vector<std::string> paths;
  for (const PathList& axis : sweep.axes) paths.push_back(axis.path);
  return paths;
}

FilmPlan film_of(const SweepRequest& request, std::size_t point) {
  FilmPlan film;
  film.scene = request.file.string();
  film.sweep_point = point;
  film.out = request.folder(point).string();
  film.folder_is_locked = true;
  film.settings = request.settings;
  film.threads = request.threads;
  film.error_every = request.error_every;
  film.pictures = request.pictures;
  film.video = request.pictures == FilmPictures::all;
  film.checkpoint_every = 0;
  film.gl = *value_named<GlChoice>(request.gl);
  film.cache = request.cache;
  film.quiet = request.quiet;
  return film;
}

// Returns why a run failed, from the "failed: ..." of its run.json; empty where it did not fail.
std::string failure_in(const Json& run) {
  const std::string ended = run.is_object() ? run.value("ended", "") : "";
  return ended.starts_with("failed: ") ? ended.substr(8) : "";
}

// Describes how the sweep of a record differs from this one; empty where it is the same.
std::string other_sweep(const SweepRequest& request, const Json& record) {
  const Json sweep = record.is_object() ? record.value("sweep", Json()) : Json();
  if (!sweep.is_object()) return "";
  const Json scene = sweep.value("scene", Json()), paths = sweep.value("paths", Json());
  const Json now = paths_of(request.sweep);
  if (scene != request.name)
    return fmt::format("the scene is {} there and \"{}\" here", exact_json_text(scene), request.name);
  return paths == now ? ""
                      : fmt::format("the paths are {} there and {} here", exact_json_text(paths), exact_json_text(now));
}

}  // namespace

void check_folder(const SweepRequest& request) {
  const std::string option = "--out " + request.out.string();
  std::error_code error;
  if (!std::filesystem::exists(request.out, error)) return;
  if (!std::filesystem::is_directory(request.out, error)) throw InputError(option, "exists and is not a folder");
  // The folder is examined in this order because other points may start at this moment, and they create points/ first.
  const bool empty = std::filesystem::is_empty(request.out, error);
  const bool of_a_sweep = std::filesystem::is_directory(request.out / "points", error) &&
                          !std::filesystem::exists(request.out / "run.json", error);
  if (!of_a_sweep && !empty)
    throw InputError(option, "holds files that no sweep left there; choose another folder or empty it");
  bool known = false;  // one record tells of all
  for (const auto& entry : std::filesystem::directory_iterator(request.out / "points", error)) {
    const std::string name = entry.path().filename().string();
    const bool surplus = name.find_first_not_of("0123456789") == std::string::npos && name.size() < 10 &&
                         std::stoul(name) >= request.sweep.points();
    std::string difference;
    if (!known) {
      const auto record = json_object_in<Json>(entry.path() / "point.json");
      known = record.is_object();
      difference = other_sweep(request, record);
    }
    if (difference.empty() && surplus)
      difference =
          fmt::format("it has a point {}, and the last one here is {}", std::stoul(name), request.sweep.points() - 1);
    if (!difference.empty())
      throw InputError(option, "holds another sweep: " + difference + "; choose another folder or empty it");
  }
}

std::filesystem::path SweepRequest::folder(std::size_t point) const {
  const std::size_t digits = std::max<std::size_t>(4, std::to_string(sweep.points() - 1).size());
  return out / "points" / fmt::format("{:0{}}", point, digits);
}

std::filesystem::path SweepRequest::record(std::size_t point) const { return folder(point) / "point.json"; }

std::string end_text(PointEnd end) {
  switch (end) {
    case PointEnd::done: return "done";
    case PointEnd::failed: return "failed";
    case PointEnd::interrupted: return "interrupted";
    case PointEnd::outdated: return "outdated";
    case PointEnd::unfinished: return "unfinished";
    case PointEnd::not_run: break;
  }
  return "not run";
}

void record_point(const SweepRequest& request, std::size_t point, const JobOutcome& outcome) {
  Json json = made_with(request, point);
  json["sweep"] = {{"scene", request.name}, {"paths", paths_of(request.sweep)}};
  json["error_every"] = request.error_every;
  json["pictures"] = name_of(request.pictures);
  write_job_record(request.record(point), json, outcome);
}

int run_point(const SweepRequest& request, std::size_t point, const std::vector<std::string>& command) {
  const std::filesystem::path folder = request.folder(point);
  const FolderLock lock(folder);
  std::error_code error;
  for (const char* stale : {"point.json", "profile.json"}) std::filesystem::remove(folder / stale, error);
  const Stopwatch watch;
  const auto record = [&](int status, const std::string& message) {
    record_point(request, point, {status, message, watch.elapsed_ms() / 1000});
  };
  try {
    const int status = run_film({film_of(request, point)}, command);
    record(status, status == 1 ? failure_in(json_object_in<Json>(folder / "run.json")) : "");
    return status;
  } catch (const InputError& wrong) {
    record(2, wrong.what());
    throw;
  } catch (const std::exception& wrong) {
    record(1, wrong.what());
    throw;
  }
}

PointOutcome outcome_of(const SweepRequest& request, std::size_t point) {
  const auto record = json_object_in<Json>(request.record(point));
  const auto run = json_object_in<Json>(request.folder(point) / "run.json");
  PointOutcome outcome;
  if (!record.is_object()) {
    if (run.is_object()) outcome = {PointEnd::unfinished, "", "still running, or ended without a word", 0};
    return outcome;
  }
  const JobOutcome kept = outcome_in(record);
  outcome = {PointEnd::failed, std::to_string(kept.exit_status), kept.message, kept.wall_s.value_or(0)};
  const Json now = made_with(request, point);
  if (record.value("program", "") != now["program"] || record.value("scene", "") != now["scene"]) {
    outcome.end = PointEnd::outdated;
    outcome.message = record.value("program", "") != now["program"] ? "was made by another build of the program"
                                                                    : "was made from another scene or other settings";
  } else if (kept.exit_status == 130) {
    outcome.end = PointEnd::interrupted;
  } else if (kept.exit_status == 0 && run.is_object() && run.value("ended", "") == "done") {
    outcome.end = PointEnd::done;
  }
  return outcome;
}

bool has_what_is_asked(const SweepRequest& request, std::size_t point) {
  const auto record = json_object_in<Json>(request.record(point));
  if (!record.is_object() || record.value("error_every", 0) != request.error_every) return false;
  const auto drawn = value_named<FilmPictures>(record.value("pictures", ""));
  return request.pictures == FilmPictures::none || drawn == FilmPictures::all || drawn == request.pictures;
}

}  // namespace supple
