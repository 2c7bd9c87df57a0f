// Describes a sweep as it was asked for and its points: where each one runs, and what is known of those that have run.
// points/0007/ holds the run of point 7. Its point.json records to which sweep it belongs, with what it was made, how
// it ended, and how long it took.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/jobs.h"
#include "film/plan/film_plan.h"
#include "scene/reading/sweep.h"

namespace supple {

struct SweepRequest {
  std::string scene;  // as the command line has it
  std::filesystem::path file;
  std::string name, title;  // of the scene
  std::filesystem::path out;
  std::vector<std::string> settings;  // path=value over the scene's, for all points
  SweepDef sweep;
  FilmPictures pictures = FilmPictures::last;  // of each point's film; all: with a video
  int error_every = 0;
  int threads = 1;  // of a point
  std::string gl = "auto";
  bool cache = true;
  bool quiet = false;

  std::filesystem::path folder(std::size_t point) const;
  std::filesystem::path record(std::size_t point) const;  // its point.json
};

enum class PointEnd { done, failed, interrupted, outdated, unfinished, not_run };

// Holds all that is known of a point.
struct PointOutcome {
  PointEnd end = PointEnd::not_run;
  std::string exit_status;  // empty while unknown
  std::string message;      // why it failed or does not count
  double wall_s = 0;
};

std::string end_text(PointEnd end);

// Throws InputError when --out is not a folder, when it holds files that do not come from a sweep, and when it holds
// points of another sweep: one of another scene, of other paths, or of more points. A changed value or a changed text
// of the scene only makes the points outdated.
void check_folder(const SweepRequest& request);

// Runs one point in this process and records how it ended; returns the exit status. command: the command line with
// which the program was called. Throws what the run throws, after recording it.
int run_point(const SweepRequest& request, std::size_t point, const std::vector<std::string>& command);

// Records how a point ended.
void record_point(const SweepRequest& request, std::size_t point, const JobOutcome& outcome);

// Returns how a point ended, judged by the content of its folder. It counts as done if its run.json says so and if
// program and scene are the same.
PointOutcome outcome_of(const SweepRequest& request, std::size_t point);

// Tells whether a done point also has the pictures and errors that are asked for.
bool has_what_is_asked(const SweepRequest& request, std::size_t point);

}  // namespace supple
