// Draws a film again from the motion that a run has saved: with another camera, look or size, or only some of its
// frames. Nothing is simulated. With the run's own settings the pictures have the same bytes as the run's. A drawing is
// a folder with draw.json, frames/ and video.mp4. Its frames are independent of each other, so several processes can
// draw parts of it into one folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "film/pictures/pictures.h"
#include "film/plan/loaded_film.h"
#include "output/motion/force_file.h"
#include "output/motion/point_cache.h"
#include "output/run/profile.h"

namespace supple {

// Describes what to draw.
struct DrawPlan {
  std::filesystem::path run;            // the folder of the run
  std::filesystem::path scene;          // the scene's file, where it is not where the run found it; else empty
  std::vector<std::string> settings;    // path=value, in place of the run's values; only of what is seen
  int first = 0, last = -1, every = 1;  // frames of the run; last < 0: the run's last frame
  int smooth = 1;                       // pictures for each of these frames; those between are interpolated
  std::optional<FrameRate> rate;        // of the drawn film; nothing: the run's, over `every`
  GlChoice gl = GlChoice::automatic;
  bool legend_apart = false;  // pictures have no legend; the result holds it
  bool cache = true;          // of meshes and skins
  bool quiet = false;         // no progress while meshing
};

// Holds a run that is ready to be drawn.
struct LoadedDrawing {
  LoadedFilm film;  // without models
  std::vector<PointCacheReader> motion;
  std::vector<ForceFileReader> forces;  // forces of contact on each body; empty where the drawing does not need them
  std::vector<FrameRow> rows;           // of the run's profile; empty while the run goes on
  int frame_count = 0;                  // of the run
  std::vector<int> frames;              // of the run, that are drawn
  int smooth = 1;                       // pictures for each of them but the last
  FrameRate rate = 30;                  // of the film
  std::string identity;                 // JSON: all that the pictures depend on
};

// Reads the run, its scene and its meshes. Throws InputError when the folder does not hold a run with all its motion,
// when the scene differs from the run's in more than what is seen, and when a mesh is not the run's.
LoadedDrawing load_drawing(const DrawPlan& plan);

// Names a time of the run: a frame, and the share of the way to the next one.
struct Moment {
  int frame;
  double share;
};
int picture_count(const LoadedDrawing& drawing);
Moment moment_of(const LoadedDrawing& drawing, int picture);

// Returns the positions of a body's mesh that the run saved for a frame [m].
Positions saved_positions(LoadedDrawing& drawing, std::size_t body, int frame);

// Creates the folder of a drawing, or takes over one that an earlier drawing left. The earlier pictures and film are
// removed unless `keep` is set; with `keep`, they must belong to the same drawing. Throws InputError when the folder
// holds anything else.
void open_drawing(const std::filesystem::path& folder, const LoadedDrawing& drawing, bool keep);

// Selects pictures by their numbers, from `first` up to but not including `last`.
struct PictureRange {
  int first, last;
};
// Returns the part of the pictures that process `index` of `count` draws.
PictureRange part_of(const LoadedDrawing& drawing, int index, int count);

struct DrawResult {
  FilmEnd end = FilmEnd::done;
  std::string message;                   // why it failed
  int pictures = 0;                      // number of pictures that are whole
  std::optional<FieldLook> legend = {};  // of the field, where there is one
};

// Returns the range of the drawing's field, which the scene must have. It follows from the whole run where the scene
// says so (FieldRange::film).
Eigen::Vector2d field_range(LoadedDrawing& drawing);

// Draws pictures into the folder's frames/, and hands them to `video` where there is one. Calls told(done) from time to
// time with the number of pictures done.
DrawResult draw_pictures(const DrawPlan& plan, LoadedDrawing& drawing, const std::filesystem::path& folder,
                         PictureRange range, VideoEncoder* video, const std::function<void(int done)>& told);

// Draws one frame of the run. Throws RunError.
Image draw_still(const DrawPlan& plan, LoadedDrawing& drawing, int frame);

// Returns the numbers of the pictures that the folder lacks.
std::vector<int> missing_pictures(const LoadedDrawing& drawing, const std::filesystem::path& folder);

}  // namespace supple
