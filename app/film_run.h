// A film from the command line to its folder: what the verbs that run a scene have in common.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/frame_loop.h"
#include "app/verbs.h"
#include "base/trace.h"

namespace supple {

// As the command line gives it.
struct FilmRequest {
  std::string scene;
  std::optional<std::size_t> sweep_point;  // of the scene's sweep; otherwise the scene as it stands
  std::string out;
  bool folder_is_held = false;  // who calls has the lock of `out`
  int frames = 0;               // 0: the scene's
  int threads = 0;
  std::vector<std::string> set;
  int error_every = 0;
  int fields_every = 0;
  std::vector<int> save_states;
  long long seed = -1;
  bool no_video = false, no_images = false, last_image_only = false, trace = false, quiet = false, json = false;
  bool table = true;  // at the end
  std::string gl = "auto";
  int checkpoint_every = 60;
  bool resume = false;
  std::string record, verify;
  std::optional<double> tolerance;
};

// The options that every run of a scene has; to resume is for single films.
void add_film_options(CLI::App& verb, FilmRequest& request);

// What is known of a run once it is over, for who looks closer.
struct FilmRecord {
  RunInfo info;
  std::filesystem::path folder;
  std::string scene;  // its name
  double fps = 0;
  FilmResult result;
  std::vector<ThreadTrace> trace;  // when one was asked for
};

// Makes a verb one that films what its argument names.
struct FilmArgument {
  const char *name, *meaning;
};
void add_film(CLI::App& verb, const FilmArgument& argument, Action& action, const std::vector<std::string>& command);

// Every change of a script once, so that what cannot be is said before anything is written. Throws InputError with all
// that the bodies refuse.
void try_changes(const Script& script, std::vector<Body> bodies);

// What is legal and unwise about a scene and its changes.
std::vector<Problem> all_warnings(const Script& script, const std::vector<Body>& bodies);

// Runs it and tells how it went; returns the exit status. command: as it was called, for run.json. record: null when
// nobody asks.
int run_film(const FilmRequest& request, const std::vector<std::string>& command, FilmRecord* record = nullptr);

}  // namespace supple
