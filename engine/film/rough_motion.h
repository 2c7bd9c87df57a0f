// Finds what a camera has in view that frames the bodies' whole motion, before the film has been made: by a rough first
// pass. What it finds is kept in run.json, so that the film can be resumed, and drawn again, with the same camera.
#pragma once

#include "film/film.h"
#include "film/rough_pass.h"

namespace supple {

// Finds the outermost points of the motion, where the camera asks for it, or where nothing places the camera and the
// bodies leave the picture of the start, and where pictures are made. A film that is resumed takes the points that it
// was begun with. Returns what is to be said about it, which is often nothing. Throws InputError and RunError.
std::string find_framing(const FilmPlan& plan, const FilmStart& start, const FilmSolvers& solvers, LoadedFilm& film);

// Tells whether a scene leaves to the program what its camera frames, and a body is not whole in a picture of the pass
// that shows the start.
bool leaves_picture(const RoughPass& pass, DrawnFilm& drawn);

}  // namespace supple
