// Runs jobs, several at a time: for each, this program once more in a process of its own. A job may keep its outcome in
// a small JSON file, its record. The record also says what the job was made with: all that its outcome depends on and
// that is cheap to know. A job need not be run again if it succeeded according to its record, and what it was made with
// has not changed. Not here: what a job depends on, which jobs are left, and the words about each, which their verb
// knows.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace supple {

struct Job {
  std::vector<std::string> words;     // its command line, after the name of the program
  std::filesystem::path record = {};  // removed before the job starts
};

// Tells how the process of a job ended.
struct JobEnd {
  std::size_t job = 0;     // from 0
  std::size_t ended = 0;   // number of jobs that have ended so far, this one included
  bool cut_short = false;  // the process was asked to end, so that it may have left only a part
  int status = 0;          // exit status as a shell gives it: after signal n, 128 + n
  std::string how;         // "ended with status 1"
  std::string output;      // the last 4 kB of what it wrote to the terminal
  double seconds = 0;
};

struct JobList {
  std::string kind;  // what a job is for: "scene"
  std::size_t count = 0;
  int at_once = 1;
  std::function<Job(std::size_t job)> job;          // several threads may call it
  std::function<void(const JobEnd& end)> on_ended;  // one thread at a time calls it
};

// Runs the jobs, and returns when all have ended. After an interrupt (base/interrupts.h), the jobs that run are ended
// and no more are started. Throws RunError when the program cannot be started, and whatever the two functions throw;
// the jobs that run are ended first.
void run_jobs(const JobList& jobs);

// Holds the outcome of a job as its record has it.
struct JobOutcome {
  int exit_status = 1;
  std::string message;                // why it failed
  std::optional<double> wall_s = {};  // how long it took, where that is kept
};

// Writes a record, and makes its folder. made_with: an object. Throws RunError when it cannot be written.
void write_job_record(const std::filesystem::path& file, nlohmann::ordered_json made_with, const JobOutcome& outcome);

// Returns the outcome in a record, which is the object of such a file.
JobOutcome outcome_in(const nlohmann::ordered_json& record);

}  // namespace supple
