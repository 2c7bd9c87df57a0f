// Takes a film from its plan to its folder, without a command line: the film is loaded and checked, its folder is
// opened, and the film is made. Each of these parts is a function, so that a program can print what it likes between
// them. Not here: the loop over frames (frame_loop.h).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/trace.h"
#include "film/plan/film_plan.h"
#include "film/plan/loaded_film.h"
#include "film/plan/run_choice.h"
#include "film/record/repeated_cuts.h"
#include "film/record/state_record.h"
#include "output/files/folder_lock.h"
#include "output/run/frame_rows.h"
#include "output/run/row_tally.h"
#include "output/run/run_folder.h"
#include "world/world_state.h"

namespace supple {

struct FilmSolvers;  // film_solvers.h

// Describes how a film starts: where, and after which frames of an earlier run.
struct FilmStart {
  RunPlace place;                    // of the run's folder
  std::unique_ptr<FolderLock> lock;  // the lock on the folder; null where the caller holds it
  std::string identity;              // identity of the film that a checkpoint belongs to
  int checkpoint_every = 0;          // frames; 0: never
  std::optional<WorldState> checkpoint;
  RecordHead record_head;
  std::optional<StateVerifier> verifier;
  std::vector<CutsByFrame> repeated;  // cuts by body for --repeat; empty without it

  int kept_frames() const { return checkpoint ? checkpoint->frames : 0; }
};

// Refuses a film that cannot be made, before anything in the folder is changed, and finds where the film starts. Throws
// InputError.
FilmStart check_film(const FilmPlan& plan, const LoadedFilm& film);

// Takes the folder for this run and writes run.json into it. Throws InputError and RunError.
RunFolder open_folder(FilmStart& start, LoadedFilm& film);

struct FilmResult {
  FilmEnd end = FilmEnd::done;
  std::string message;  // why it failed, for people
  FrameRows rows;       // rows of the finished frames
  RowTally tally;       // tally of `rows`
  int kept_frames = 0;  // finished frames that an earlier run made
  std::string gl_backend, gl_renderer, gl_version;
  std::string video_message;  // why there is no video
  bool video_written = false;
  std::filesystem::path video;  // file of the video, where it was written
  bool video_failed = false;    // ffmpeg is there, but did not make the video
  double encode_ms = 0;         // processor time of the encoder for a frame of the video; 0: no video
  double setup_ms = 0;
  double wall_ms = 0;  // of the loop
  std::vector<std::filesystem::path> stills;
  std::string stills_message;  // why there are no stills although they were asked for
};

// Makes the frames and, where the plan asks for them, the video and the stills. Wherever the film ends, the frames that
// `rows` of the result describes are whole.
FilmResult make_film(const FilmPlan& plan, LoadedFilm& film, FilmStart& start, const RunFolder& folder,
                     const FilmSolvers& solvers);

// Says which stage costs most, and what helps (output/run/verdict.h).
std::string verdict_on(const FilmResult& result);

// Writes run.json and profile.json with all that is known of the film at its end, and the trace where there is one.
// Returns a message when a file could not be written, and nothing otherwise.
std::string write_records(const FilmResult& result, LoadedFilm& film, const RunFolder& folder,
                          const std::vector<ThreadTrace>* trace);

}  // namespace supple
