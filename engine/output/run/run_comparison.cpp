#include "output/run/run_comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "output/files/json_text.h"
#include "output/files/obj_file.h"
#include "output/motion/point_cache.h"

namespace supple {
namespace {

void check_profile(const RunRecord& run) {
  if (!run.has_profile) {
    throw InputError(run.folder.string(),
                     fmt::format("there is no profile.json in it: the run did not come to its end ({})", run.ended()));
  }
  if (run.rows.empty())
    throw InputError(run.folder.string(), "no frame of this run is whole; there is nothing to compare");
}

std::vector<std::string> body_names(const RunRecord& run) {
  std::vector<std::string> names;
  for (const BodyRow& body : run.rows.front().bodies) names.push_back(body.name);
  return names;
}

// Opens the point cache of a body, which must hold at least this many frames.
PointCacheReader open_motion(const RunRecord& run, const std::string& body, int frames) {
  PointCacheReader reader(run.motion(body));
  if (reader.frames() < frames) {
    throw InputError(run.motion(body).string(),
                     fmt::format("holds {} of the {} frames that profile.json has", reader.frames(), frames));
  }
  return reader;
}

// Returns the median of a body's steps over all frames but the first, which warms caches.
double median_step_of(const std::vector<FrameRow>& rows, const std::string& name) {
  std::vector<double> ms;
  for (std::size_t i = rows.size() > 1 ? 1 : 0; i < rows.size(); ++i) {
    const auto body = std::ranges::find(rows[i].bodies, name, &BodyRow::name);
    if (body != rows[i].bodies.end()) ms.push_back(body->step_ms);
  }
  return distribution_of(ms).p50;
}

BodyComparison compare_body(const RunRecord& a, const RunRecord& b, const std::string& name, int frames) {
  PointCacheReader motion_a = open_motion(a, name, frames), motion_b = open_motion(b, name, frames);
  BodyComparison body;
  body.name = name;
  body.vertices_a = motion_a.points();
  body.vertices_b = motion_b.points();
  body.saved_a = motion_a.frames();
  body.saved_b = motion_b.frames();
  body.step_ms_a = median_step_of(a.rows, name);
  body.step_ms_b = median_step_of(b.rows, name);
  body.size = bounds_of(motion_a.frame(0)).diagonal();
  if (body.vertices_a != body.vertices_b) return body;
  const Vec3 apart = origin_of_obj(b.surface(name)) - origin_of_obj(a.surface(name));
  for (int frame = 0; frame < frames; ++frame) {
    const Positions moved = (motion_b.frame(frame) - motion_a.frame(frame)).rowwise() + apart.transpose();
    FrameDistance distance;
    for (Eigen::Index v = 0; v < moved.rows(); ++v) distance.largest = std::max(distance.largest, moved.row(v).norm());
    distance.rms = std::sqrt(moved.squaredNorm() / double(std::max<Eigen::Index>(1, moved.rows())));
    body.distance.push_back(distance);
    if (distance.largest > 0 && !body.first_difference) body.first_difference = frame;
    if (distance.largest > body.distance[body.worst_frame].largest) body.worst_frame = frame;
  }
  return body;
}

double median_step(const std::vector<FrameRow>& rows) {
  const StageSummary step = summarize(rows).front();
  return rows.size() > 1 ? step.rest.p50 : step.first;
}

// Returns the part of run.json that tells what was run, without how the run itself went.
std::string what_was_run(const RunRecord& run) {
  auto info = parsed_json<nlohmann::ordered_json>(run.info_json);
  for (const char* key : {"command", "ended", "frames", "resumed_at", "video"}) info.erase(key);
  return json_text(info);
}

}  // namespace

bool RunComparison::same_states() const {
  return !first_difference && frames_a == frames_b && only_a.empty() && only_b.empty() &&
         std::ranges::all_of(bodies, [](const BodyComparison& body) { return body.vertices_a == body.vertices_b; });
}

bool RunComparison::only_motion_differs(const BodyComparison& body) const {
  if (body.first_difference) return *body.first_difference < first_difference.value_or(frames);
  return !first_difference && frames_a == frames_b && body.saved_a != body.saved_b;
}

bool RunComparison::same_motion() const {
  const auto same = [](const BodyComparison& body) {
    return !body.first_difference && body.vertices_a == body.vertices_b && body.saved_a == body.saved_b;
  };
  return only_a.empty() && only_b.empty() && std::ranges::all_of(bodies, same);
}

RunComparison compare_runs(const RunRecord& a, const RunRecord& b) {
  check_profile(a);
  check_profile(b);
  RunComparison result;
  result.frames_a = static_cast<int>(a.rows.size());
  result.frames_b = static_cast<int>(b.rows.size());
  result.frames = std::min(result.frames_a, result.frames_b);
  for (int frame = 0; frame < result.frames; ++frame) {
    result.time_s.push_back(a.rows[frame].time_s);
    if (!result.first_difference && a.rows[frame].state_hash != b.rows[frame].state_hash)
      result.first_difference = frame;
  }
  const std::vector<std::string> names_a = body_names(a), names_b = body_names(b);
  for (const std::string& name : names_a) {
    if (std::ranges::find(names_b, name) == names_b.end()) {
      result.only_a.push_back(name);
    } else {
      result.bodies.push_back(compare_body(a, b, name, result.frames));
    }
  }
  for (const std::string& name : names_b) {
    if (std::ranges::find(names_a, name) == names_a.end()) result.only_b.push_back(name);
  }
  result.step_ms_a = median_step(a.rows);
  result.step_ms_b = median_step(b.rows);
  result.differences = differing_values(what_was_run(a), what_was_run(b));
  return result;
}

}  // namespace supple
