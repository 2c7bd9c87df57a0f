#include "app/bench/world_crossings.h"

namespace supple {
namespace {

Positions joined_places(TouchingFilm& film) {
  Eigen::Index rows = 0;
  for (std::size_t b = 0; b < film.world().size(); ++b) rows += film.world().body(b).model().vertices;
  Positions all(rows, 3);
  Eigen::Index at = 0;
  for (std::size_t b = 0; b < film.world().size(); ++b) {
    const Positions& x = film.world().body(b).state().x;
    all.middleRows(at, x.rows()) = x;
    at += x.rows();
  }
  return all;
}

Triangles joined_surfaces(TouchingFilm& film) {
  Eigen::Index rows = 0;
  for (std::size_t b = 0; b < film.world().size(); ++b) rows += film.world().body(b).model().surface.rows();
  Triangles all(rows, 3);
  Eigen::Index at = 0;
  std::int32_t first = 0;
  for (std::size_t b = 0; b < film.world().size(); ++b) {
    const Model& model = film.world().body(b).model();
    all.middleRows(at, model.surface.rows()) = model.surface.array() + first;
    at += model.surface.rows();
    first += model.vertices;
  }
  return all;
}

}  // namespace

WorldCrossings::WorldCrossings(TouchingFilm& film)
    : film_(film), crossings_(joined_surfaces(film), joined_places(film)) {}

EdgeCrossings::Count WorldCrossings::count() { return crossings_.count(joined_places(film_)); }

}  // namespace supple
