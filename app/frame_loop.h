// The loop that makes a film: step, draw, compress, overlapped through bounded queues. Nothing that a later stage does
// can change a result.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/checkpoint.h"
#include "app/state_record.h"
#include "output/profile.h"
#include "output/run_folder.h"
#include "render/gl_context.h"
#include "scene/assemble.h"
#include "scene/script.h"

namespace supple {

struct FilmOptions {
  int threads = 1;
  int error_every = 0;           // measure equation 12 every so many frames; 0: never
  int fields_every = 0;          // write fields every so many frames; 0: never
  std::vector<int> save_states;  // frames before which the bodies' states are written
  bool images = true;
  std::vector<int> pictured;  // with images: which frames are drawn; empty: all
  bool video = true;
  GlChoice gl = GlChoice::automatic;
  bool quiet = false;
  std::filesystem::path shaders;
  std::string font;
  int checkpoint_every = 0;         // frames; 0: never
  std::string identity;             // of what a checkpoint belongs to
  std::optional<Checkpoint> start;  // to go on from
  std::filesystem::path record;     // empty: none
  RecordHead record_head;
  StateVerifier* verifier = nullptr;  // may be null: nothing to compare with
};

enum class FilmEnd { done, interrupted, failed };

struct FilmResult {
  FilmEnd end = FilmEnd::done;
  std::string message;         // why it failed, for people
  std::vector<FrameRow> rows;  // of finished frames
  int kept_frames = 0;         // of them, of an earlier run
  std::string gl_backend, gl_renderer, gl_version;
  std::string video_message;  // why there is no film
  bool video_written = false;
  bool video_failed = false;  // ffmpeg is there, and did not make it
  double setup_ms = 0;
  double wall_ms = 0;  // the loop
};

// Runs a scene into a folder. Whatever happens, the frames before it are whole, and rows tells of them.
FilmResult make_film(const Script& script, std::vector<Body>& bodies, std::vector<Model>& models,
                     const RunFolder& folder, const FilmOptions& options);

// True once SIGINT, SIGTERM or SIGHUP (the terminal is gone; not under nohup) asked the run to end after the frame in
// progress.
bool interrupted();
void catch_interrupts();

}  // namespace supple
