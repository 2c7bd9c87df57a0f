#include "app/sweep/run_points.h"

#include <fmt/core.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

#include "app/sweep/merge.h"
#include "base/console.h"
#include "base/error.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "base/timing.h"
#include "film/plan/shipped_files.h"
#include "output/files/child_program.h"
#include "output/files/folder_lock.h"

namespace supple {
namespace {

// Returns the command that runs one point, as a user would type it.
std::vector<std::string> command_of(const SweepRequest& request, std::size_t point) {
  std::vector<std::string> words = {std::filesystem::read_symlink("/proc/self/exe").string(),
                                    "sweep",
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

// Hands out points to threads, each of which waits for one process at a time.
class PointQueue {
 public:
  PointQueue(const SweepRequest& request, std::vector<std::size_t> points)
      : request_(request), points_(std::move(points)) {}

  void run(int jobs) {
    std::vector<std::thread> workers;
    for (int i = 0; i < jobs; ++i) workers.emplace_back([this] { work(); });
    for (std::thread& worker : workers) worker.join();
    if (!error_.empty()) throw RunError(error_);
  }

 private:
  void work() {
    try {
      while (!interrupted() && !stopped_) {
        const std::size_t next = next_++;
        if (next >= points_.size()) return;
        run_one(points_[next]);
      }
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      error_ = error.what();
      stopped_ = true;
    }
  }

  void run_one(std::size_t point) {
    const Stopwatch watch;
    std::error_code error;
    std::filesystem::remove(request_.folder(point) / "point.json", error);  // of an earlier run
    const auto end = run_program(command_of(request_, point), [this] { return interrupted() || stopped_.load(); });
    if (!end) throw RunError("the program cannot be started once more for a point");
    PointOutcome outcome = outcome_of(request_, point);
    const bool asked_to_end = interrupted() || stopped_;
    if (!asked_to_end && end->status != 0 && outcome.exit_status.empty()) {
      const int status = WIFSIGNALED(end->status) ? 128 + WTERMSIG(end->status) : WEXITSTATUS(end->status);
      record_failure(request_, point, status, how_it_ended(*end));
      outcome = outcome_of(request_, point);
    }
    const std::lock_guard lock(mutex_);
    ++ended_;
    if (request_.quiet || (asked_to_end && outcome.end != PointEnd::done)) return;
    say(stderr, fmt::format("point {}: {} in {} ({} of {})\n", point, end_text(outcome.end),
                            duration_text(watch.elapsed_ms() / 1000), ended_, points_.size()));
  }

  const SweepRequest& request_;
  const std::vector<std::size_t> points_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  std::size_t ended_ = 0;
  std::string error_;
};

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
  PointQueue(request, points).run(at_once);
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
