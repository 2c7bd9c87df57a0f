// Counts where surfaces of a world's bodies pass through each other or through themselves.
#pragma once

#include "app/bench/touching_film.h"
#include "geometry/triangles/edge_crossings.h"

namespace supple {

// Joins the surfaces of all bodies of a film, and counts where they cross.
class WorldCrossings {
 public:
  // film: it must outlive this object.
  explicit WorldCrossings(TouchingFilm& film);

  EdgeCrossings::Count count();  // at the end of the frame that was played last

 private:
  TouchingFilm& film_;
  EdgeCrossings crossings_;
};

}  // namespace supple
