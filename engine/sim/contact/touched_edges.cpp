#include "sim/contact/touched_edges.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace supple {

double TouchedEdges::reach_of_edge(const EdgeEnds& edge) const {
  double way = 0;
  for (const std::int32_t v : edge)
    way = std::max(way, ((x_.row(v) - q_.row(v)).transpose() - surface_.carried).norm());
  return reach_at(edge[0], way);
}

void TouchedEdges::add_pair(const EdgeEnds& edge, const EdgeEnds& other, const TwoEdges& end, const Vec3& normal,
                            double field, std::vector<Contact>& list) const {
  constexpr double least_weight = 1e-4;  // a stencil has no weights of 0
  const double s = std::clamp(end.share(), least_weight, 1 - least_weight),
               t = std::clamp(end.other_share(), least_weight, 1 - least_weight);
  const ContactStencil stencil = stencil_of<4>({edge[0], edge[1], other[0], other[1]}, {1 - s, s, t - 1, -t});
  if (stencil.free > 0) add(stencil, edge[0], normal, field, list, layer_);
}

void TouchedEdges::add_edges(const EdgeEnds& edge, const EdgeEnds& other, double reach,
                             std::vector<Contact>& list) const {
  const TwoEdges start(edge, other, q_), end(edge, other, x_);
  const bool may_cross = start.volume * end.volume < 0;
  if (!may_cross && !end.are_nearer(reach)) return;
  if (!end.are_lines()) return;
  const bool crosses = may_cross && edge_passage(edge, other, q_, x_).has_value();
  if (!crosses && !(end.are_nearer(reach) && end.meet(0))) return;
  const double side = (crosses ? start.volume : end.volume) >= 0 ? 1 : -1;
  const double field = start.meet(0) ? std::abs(start.volume) / start.across.norm() - layer_ : reach;
  add_pair(edge, other, end, side * end.across.normalized(), field, list);
}

double TouchedEdges::share_to_impact(const EdgeEnds& edge, const EdgeEnds& other, double least) const {
  if (TwoEdges(edge, other, q_).volume * TwoEdges(edge, other, x_).volume >= 0) return least;
  const std::optional<double> share = edge_passage(edge, other, q_, x_);
  if (!share || *share >= least) return least;
  const TwoEdges then = edges_at_share(edge, other, q_, x_, *share);
  const auto way = [&](const EdgeEnds& of, double part) {
    return Vec3(((1 - part) * (x_.row(of[0]) - q_.row(of[0])) + part * (x_.row(of[1]) - q_.row(of[1]))).transpose());
  };
  const Vec3 pace = way(edge, then.share()) - way(other, then.other_share());
  const double falls = std::abs(then.across.normalized().dot(pace));
  return falls > 0 ? std::min(least, std::max(0.0, *share + deepest_at_impact_ / falls)) : least;
}

}  // namespace supple
