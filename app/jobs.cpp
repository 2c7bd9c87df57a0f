#include "app/jobs.h"

#include <fmt/core.h>
#include <sys/wait.h>

#include <atomic>
#include <exception>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/companion_program.h"
#include "base/error.h"
#include "base/interrupts.h"
#include "base/timing.h"
#include "output/files/child_program.h"
#include "output/files/json_text.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

// Hands out jobs to threads, each of which waits for one process at a time.
class JobQueue {
 public:
  explicit JobQueue(const JobList& jobs) : jobs_(jobs) {}

  void run() {
    std::vector<std::thread> workers;
    for (int i = 0; i < jobs_.at_once; ++i) workers.emplace_back([this] { work(); });
    for (std::thread& worker : workers) worker.join();
    if (error_) std::rethrow_exception(error_);
  }

 private:
  bool asked_to_end() const { return interrupted() || stopped_; }

  void work() {
    try {
      for (std::size_t job = 0; !asked_to_end() && (job = next_++) < jobs_.count;) run_one(job);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      stopped_ = true;
    }
  }

  void run_one(std::size_t job) {
    const Stopwatch watch;
    Job asked = jobs_.job(job);
    std::error_code error;
    std::filesystem::remove(asked.record, error);
    asked.words.insert(asked.words.begin(), this_program().string());
    const auto end = run_program(asked.words, [this] { return asked_to_end(); });
    if (!end) throw RunError(fmt::format("the program cannot be started once more for a {}", jobs_.kind));
    const int status = WIFSIGNALED(end->status) ? 128 + WTERMSIG(end->status) : WEXITSTATUS(end->status);
    const bool cut_short = asked_to_end();
    const std::lock_guard lock(mutex_);
    jobs_.on_ended({job, ++ended_, cut_short, status, how_it_ended(*end), end->output, watch.elapsed_ms() / 1000});
  }

  const JobList& jobs_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  std::size_t ended_ = 0;
  std::exception_ptr error_;  // the first one
};

}  // namespace

void run_jobs(const JobList& jobs) { JobQueue(jobs).run(); }

void write_job_record(const std::filesystem::path& file, nlohmann::ordered_json made_with, const JobOutcome& outcome) {
  made_with["exit_status"] = outcome.exit_status;
  made_with["message"] = outcome.message;
  if (outcome.wall_s) made_with["wall_s"] = *outcome.wall_s;
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  write_whole_file(file, json_text(made_with, 1) + "\n");
}

JobOutcome outcome_in(const nlohmann::ordered_json& record) {
  JobOutcome outcome{record.value("exit_status", 1), record.value("message", "")};
  if (record.contains("wall_s")) outcome.wall_s = record.value("wall_s", 0.0);
  return outcome;
}

}  // namespace supple
