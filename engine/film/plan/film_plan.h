// Defines the plan of a film, before anything is read or made: the one struct that the command line, a sweep's points
// and other programs fill in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/names.h"
#include "output/video/video.h"
#include "render/gl_context.h"

namespace supple {

enum class FilmPictures { none, last, all };  // the frames that are drawn
template <>
struct Names<FilmPictures> {
  static constexpr std::array table = {Name{FilmPictures::none, "none"}, Name{FilmPictures::last, "last"},
                                       Name{FilmPictures::all, "all"}};
};

enum class FilmEnd { done, interrupted, failed };  // how the making of a film ended
const char* text_of(FilmEnd end);

struct FilmPlan {
  std::string scene;                       // a file of a scene or replay, or the name of one that ships
  std::optional<std::string> scene_text;   // the text of the scene's file, which then need not exist
  std::optional<std::size_t> sweep_point;  // point of the scene's sweep; nothing: the scene as it stands
  std::vector<std::string> settings;       // path=value, in place of the scene's values
  std::string size;                        // of the pictures, as output.size has it; empty: the scene's
  std::string from;                        // folder of a run from which the film goes on; empty: the scene says
  int from_frame = -1;                     // of that run; negative: its last one
  int frames = 0;                          // length of the film; 0: the scene's
  long long seed = -1;                     // of random start states; negative: the scene's

  std::string out;                // folder of the run; empty: out/NAME
  bool folder_is_locked = false;  // the caller already holds the lock on `out`
  bool resume = false;            // go on from the folder's checkpoint
  bool force = false;             // overwrite another run in the folder; otherwise a numbered folder is taken
  int checkpoint_every = 60;      // frames; 0: never

  int threads = 0;  // of the solver; 0: all cores
  FilmPictures pictures = FilmPictures::all;
  bool video = true;       // only with pictures of all frames
  bool film_only = false;  // no files of the frames and no checkpoints; only with a video
  FilmCoding coding;       // of the video
  bool stills = false;     // a poster and a sheet of pictures, where there are files of the frames
  double rough = 0;        // share of its vertices that a solid keeps in a rough pass (film/rough_pass.h); 0: no pass
  bool preview = false;    // a quarter of the size, every other frame, coarse meshes (film/plan/preview.h)
  GlChoice gl = GlChoice::automatic;
  int error_every = 0;           // measure the error of equation 12 every so many frames; 0: never
  int fields_every = 0;          // write fields every so many frames; 0: never
  std::vector<int> save_states;  // frames before which the bodies' states are written
  bool trace = false;            // write where every thread's time went

  std::string record;               // file for the states of all frames; empty: none
  std::string verify;               // file of recorded states to compare with; empty: none
  std::optional<double> tolerance;  // for `verify`, over a body's size; nothing: the bits must be the same

  std::string repeat;  // folder of a run whose cuts are repeated (film/record/repeated_cuts.h); empty: budgets decide

  bool cache = true;   // meshes and skins are kept under the user's cache folder (base/user_cache.h)
  bool quiet = false;  // no progress and no remarks

  // Returns every how many frames a picture is drawn.
  int pictures_every() const { return preview ? 2 : 1; }
  bool wants_video() const { return pictures == FilmPictures::all && video && coding.format != FilmFormat::png; }
};

}  // namespace supple
