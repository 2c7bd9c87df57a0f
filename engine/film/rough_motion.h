// Finds by a rough first pass, before a film is made, what a camera must have in view to frame the bodies' whole
// motion. What is found is kept in run.json, so that the film can be resumed, and drawn again, with the same camera.
#pragma once

#include "film/film.h"
#include "film/rough_pass.h"

namespace supple {

// Finds the outermost points of the motion and puts them into `film`, where pictures are made and the camera either
// asks for these points, or is placed by nothing while the bodies leave the picture of the start. A film that is
// resumed takes the points that it was begun with. Returns what is to be said about this, which is often nothing.
// Throws InputError and RunError.
std::string find_framing(const FilmPlan& plan, const FilmStart& start, const FilmSolvers& solvers, LoadedFilm& film);

// Tells whether a scene leaves to the program what its camera frames, and a camera that frames the start does not show
// all of each body in all frames of the pass.
bool leaves_picture(const RoughPass& pass, DrawnFilm& drawn);

}  // namespace supple
