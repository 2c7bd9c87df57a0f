#include "app/sweep/run_points.h"

#include <fmt/core.h>

#include <algorithm>
#include <thread>

#include "app/jobs.h"
#include "app/sweep/merge.h"
#include "base/console.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "film/plan/shipped_files.h"
#include "output/files/folder_lock.h"

namespace supple {
namespace {

// Returns the command line that runs one point.
std::vector<std::string> words_of(const SweepRequest& request, std::size_t point) {
  std::vector<std::string> words = {"sweep",
                                    "--index",
                                    std::to_string(point),
                                    "--out=" + request.out.string(),
                                    "--threads",
                                    std::to_string(request.threads),
                                    "--gl",
                                    request.gl,
                                    "--quiet"};
  for (const std::string& setting : request.settings) words.insert(words.end(), {"--set", setting});
  if (request.error_every > 0) words.insert(words.end(), {"--error-every", std::to_string(request.error_every)});
  if (request.pictures == FilmPictures::none) words.emplace_back("--no-images");
  if (request.pictures == FilmPictures::all) words.emplace_back("--images");
  if (!request.cache) words.emplace_back("--no-cache");
  words.insert(words.end(), {"--", request.scene});
  return words;
}

// Says how a point ended, and records it where its process could not.
void end_point(const SweepRequest& request, std::size_t point, const JobEnd& end, std::size_t points) {
  PointOutcome outcome = outcome_of(request, point);
  if (!end.cut_short && end.status != 0 && outcome.exit_status.empty()) {
    record_point(request, point, {end.status, end.how, 0});
    outcome = outcome_of(request, point);
  }
  if (request.quiet || (end.cut_short && outcome.end != PointEnd::done)) return;
  say(stderr, fmt::format("point {}: {} in {} ({} of {})\n", point, end_text(outcome.end), duration_text(end.seconds),
                          end.ended, points));
}

std::vector<std::size_t> points_to_run(const SweepRequest& request, bool again) {
  std::vector<std::size_t> points;
  for (std::size_t point = 0; point < request.sweep.points(); ++point) {
    const bool done = !again && outcome_of(request, point).end == PointEnd::done && has_what_is_asked(request, point);
    if (!done) points.push_back(point);
  }
  return points;
}

int sensible_jobs(const SweepRequest& request, int jobs, std::size_t points) {
  const int cores = std::max(1, int(std::thread::hardware_concurrency()) / request.threads);
  return int(std::min<std::size_t>(std::size_t(jobs > 0 ? jobs : cores), points));
}

}  // namespace

int run_points(const SweepRequest& request, int jobs, bool again) {
  check_sweep_points(request.file, assets_folder(), request.settings, request.sweep);
  const FolderLock lock(request.out);
  const std::vector<std::size_t> points = points_to_run(request, again);
  const std::size_t all = request.sweep.points();
  const int at_once = sensible_jobs(request, jobs, points.size());
  if (!request.quiet && points.size() < all)
    say(stderr, fmt::format("{} of {} points are done\n", all - points.size(), all));
  if (!request.quiet && !points.empty())
    say(stderr,
        fmt::format("{} point{} to run, {} at a time\n", points.size(), points.size() == 1 ? "" : "s", at_once));
  catch_interrupts();
  run_jobs({"point", points.size(), at_once,
            [&](std::size_t i) {
              return Job{words_of(request, points[i]), request.record(points[i])};
            },
            [&](const JobEnd& end) { end_point(request, points[end.job], end, points.size()); }});
  if (interrupted()) {
    const auto left = points_to_run(request, false).size();
    say(stderr,
        fmt::format("supple: interrupted; {} of {} points are done and stay in {}. The same command goes on{}\n",
                    all - left, all, request.out.string(), again ? " without --again" : ""));
    return 130;
  }
  return merge_points(request);
}

}  // namespace supple
