// A sweep as it was asked for, and its points: where each runs, and what is known of those that ran. points/0007/ holds
// the run of point 7; its point.json says how that ended, of which sweep, with what it was made, and what the clock
// said.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/sweep.h"

namespace supple {

enum class SweepPictures { none, last, all };  // of each point's film; all: with a video

struct SweepRequest {
  std::string scene;  // as it was called
  std::filesystem::path file;
  std::string name, title;  // of the scene
  std::filesystem::path out;
  std::vector<std::string> settings;  // path=value over the scene's, for all points
  SweepDef sweep;
  SweepPictures pictures = SweepPictures::last;
  int error_every = 0;
  int threads = 1;  // of a point
  std::string gl = "auto";
  bool quiet = false;

  std::filesystem::path folder(std::size_t point) const;
};

enum class PointEnd { done, failed, interrupted, outdated, unfinished, not_run };

// What is known of a point.
struct PointOutcome {
  PointEnd end = PointEnd::not_run;
  std::string exit_status;  // empty while unknown
  std::string message;      // why it failed or does not count
  double wall_s = 0;
};

std::string end_text(PointEnd end);

// Throws InputError when --out is no folder, or holds what no sweep left there, or points of another sweep: of another
// scene, of other paths, or of more points. Other values or another text of the scene make its points outdated.
void check_folder(const SweepRequest& request);

// Runs one point in this process and keeps how it ended; returns the exit status. command: as it was called. Throws
// what the run throws, after keeping it.
int run_point(const SweepRequest& request, std::size_t point, const std::vector<std::string>& command);

// For a point whose process ended without a word: keeps that it failed.
void keep_failure(const SweepRequest& request, std::size_t point, int exit_status, const std::string& message);

// From what its folder holds. A point counts as done if its run.json says so, and program and scene are the same.
PointOutcome outcome_of(const SweepRequest& request, std::size_t point);

// Whether a done point also has the pictures and errors that are asked for.
bool has_what_is_asked(const SweepRequest& request, std::size_t point);

}  // namespace supple
