// Provides the solvers that the program offers, those of engine/baselines, to films and to estimates of cost.
#pragma once

#include "film/plan/film_solvers.h"

namespace supple {

FilmSolvers all_solvers();

}  // namespace supple
