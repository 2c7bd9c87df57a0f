// Plays a film before it is made, with coarse meshes, to learn where its bodies go. Not here: what is told
// of the pictures (rough_pictures.h), and what the camera frames (rough_motion.h).
#pragma once

#include "base/user_cache.h"
#include "film/pictures/drawn_film.h"
#include "film/plan/film_solvers.h"
#include "film/plan/loaded_film.h"
#include "output/run/profile.h"

namespace supple {

// Says how much work a pass may be.
struct PassEffort {
  long long most_vertex_steps;  // over all bodies, frames and substeps; 120,000 take about a second for solids, more
                                // for cloth
  bool is_quick;                // few iterations, whatever the scene asks for
  bool follows_changes;         // whether changes of a replay are made; otherwise the pass ends before the first one
  double share = 0.06;          // share of its vertices that a solid keeps; 0.06: the coarsest; 1: the film's own
};

using FramePositions = std::vector<Positions>;  // by body: the positions of its mesh, n x 3 [m]

struct RoughPass {
  LoadedFilm film;                     // coarse
  std::vector<FramePositions> motion;  // after each frame; with no frame to play, the start; empty: the first failed
  int frames = 0;                      // number played; fewer than the film's where they would take too long
  UserCache cache;                     // in which its skins are kept
};

// Plays as much as the effort allows, up to the first frame that fails. Throws InputError.
RoughPass rough_pass(const FilmPlan& plan, const FilmSolvers& solvers, const PassEffort& effort);

// Returns what is drawn of a pass: bodies by their elements, and colliders, without words.
DrawnFilm drawn_pass(const RoughPass& pass);

// Returns a row for each frame of a pass, with how much of each body its picture shows.
std::vector<FrameRow> rows_of(const RoughPass& pass, DrawnFilm& drawn);

// Returns the outermost points of the pass's motion and of the bodies of `whole` at rest, moved outwards a little [m].
// whole: the film with its own meshes, or the pass's.
std::vector<Vec3> outermost_points(const RoughPass& pass, const LoadedFilm& whole);

}  // namespace supple
