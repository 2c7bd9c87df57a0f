// The solvers that the program offers: those of engine/baselines, as films and estimates of cost take them.
#pragma once

#include "film/film_solvers.h"

namespace supple {

FilmSolvers all_solvers();

}  // namespace supple
