// Finds where a camera that frames a whole film stands before the film has been made: by a rough first pass, which
// simulates the scene with meshes as coarse as can be. The box that it finds is kept in run.json, so that the film can
// be resumed, and drawn again, with the same camera.
#pragma once

#include "film/film.h"

namespace supple {

// Finds the box of the bodies' motion, where the scene's camera asks for it and pictures are made. A film that is
// resumed takes the box that it was begun with. Throws InputError and RunError.
void find_framing(const FilmPlan& plan, const FilmStart& start, const FilmSolvers& solvers, LoadedFilm& film);

}  // namespace supple
