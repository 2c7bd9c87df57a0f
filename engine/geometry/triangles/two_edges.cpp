#include "geometry/triangles/two_edges.h"

namespace supple {
namespace {

constexpr double beyond = 1e-6;  // of an edge's length; edges that pass so near to their ends pass through each other

// Tells whether the boxes in which two edges move overlap, or nearly, as seen from the first end of the one.
bool boxes_meet(const EdgeEnds& one, const EdgeEnds& other, const Positions& q, const Positions& x) {
  const Vec3 a = q.row(one[0]), b = x.row(one[0]);
  const Vec3 from = q.row(one[1]).transpose() - a, to = x.row(one[1]).transpose() - b;
  const Vec3 low = from.cwiseMin(to).cwiseMin(0), high = from.cwiseMax(to).cwiseMax(0);
  const Vec3 c = q.row(other[0]).transpose() - a, d = x.row(other[0]).transpose() - b;
  const Vec3 e = q.row(other[1]).transpose() - a, f = x.row(other[1]).transpose() - b;
  const double nearly = 4 * beyond * (from.norm() + to.norm() + (e - c).norm() + (f - d).norm());
  return (c.cwiseMin(d).cwiseMin(e.cwiseMin(f)).array() - nearly <= high.array()).all() &&
         (c.cwiseMax(d).cwiseMax(e.cwiseMax(f)).array() + nearly >= low.array()).all();
}

}  // namespace

TwoEdges edges_at_share(const EdgeEnds& one, const EdgeEnds& other, const Positions& q, const Positions& x,
                        double share) {
  const auto place = [&](std::int32_t v) { return Vec3(((1 - share) * q.row(v) + share * x.row(v)).transpose()); };
  return {place(one[0]), place(one[1]), place(other[0]), place(other[1])};
}

std::optional<double> edge_passage(const EdgeEnds& one, const EdgeEnds& other, const Positions& q, const Positions& x) {
  constexpr int intervals = 8, halvings = 27;
  if (!boxes_meet(one, other, q, x)) return std::nullopt;
  double before = TwoEdges(one, other, q).volume;
  for (int k = 1; k <= intervals; ++k) {
    double low = double(k - 1) / intervals, high = double(k) / intervals;
    const double after = edges_at_share(one, other, q, x, high).volume;
    if (before * after < 0) {
      for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (low + high);
        (before * edges_at_share(one, other, q, x, middle).volume > 0 ? low : high) = middle;
      }
      if (edges_at_share(one, other, q, x, low).meet(beyond)) return low;
    }
    before = after;
  }
  return std::nullopt;
}

}  // namespace supple
