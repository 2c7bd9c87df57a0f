#include "sim/contact/own_sheet_points.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/contact/reach.h"
#include "sim/model/joined_model.h"

namespace supple {
namespace {

EdgeEnds joined(const Part& part, const EdgeEnds& edge) {
  return {joined_vertex(part, edge[0]), joined_vertex(part, edge[1])};
}

}  // namespace

// Returns how near each other the sides of a pair need a plane [m]. way, freely: the motions of one side relative to
// the other, to the iterate and to the prediction [m].
double OwnSheetPoints::reach_of_pair(const Vec3& way, const Vec3& freely) const {
  return reach_of(way.norm(), std::max(freely.norm(), fall_));
}

void OwnSheetPoints::add_point(const OwnSheet::PointPair& pair, std::vector<Contact>& list) const {
  const std::int32_t v = joined_vertex(part_, pair.vertex);
  const auto corners = [&](const Positions& x) {
    return OwnSheet::Corners{x.row(corner(pair.triangle, 0)), x.row(corner(pair.triangle, 1)),
                             x.row(corner(pair.triangle, 2))};
  };
  const Vec3 a = q_.row(v), b = x_.row(v);
  const OwnSheet::Corners after = corners(x_);
  const std::optional<OwnSheet::Over> end = OwnSheet::over(after, b);
  const bool may_cross = pair.volume * OwnSheet::volume(after, b) < 0;
  if (!end && !may_cross) return;
  const OwnSheet::Corners before = corners(q_), freely = corners(y_);
  const auto motion = [&](const Vec3& to, const OwnSheet::Corners& ends) {
    Vec3 sum = to - a;
    for (std::size_t k = 0; k < 3; ++k) sum -= (ends[k] - before[k]) / 3;
    return sum;
  };
  const double layer = surface_.layer, reach = reach_of_pair(motion(b, after), motion(y_.row(v), freely)) + layer;
  const std::optional<Entry> crossing =
      may_cross ? surface_.moving->first_crossing(std::span(&pair.triangle, 1), a, b, 1) : std::nullopt;
  if (!crossing && (!end || std::abs(end->above) >= reach)) return;
  const Vec3 normal = normal_of(pair.triangle, x_);
  if (normal.isZero(0)) return;
  double side = end && end->above < 0 ? -1 : 1;
  if (crossing) {
    // The crossing's normal is the triangle's, or the opposite one where the point came from behind.
    const Vec3 then = normal_of(pair.triangle, q_) + normal;
    side = then.dot(crossing->normal) >= 0 ? 1 : -1;
  }
  const Place place{pair.triangle, end ? end->weights : crossing->weights, Vec3::Zero(), 0, side * normal};
  const std::optional<OwnSheet::Over> start = OwnSheet::over(before, a);
  add(v, place, start && !crossing ? std::abs(start->above) - layer : reach, list, layer);
}

void OwnSheetPoints::add_edges(const OwnSheet::EdgePair& pair, std::vector<Contact>& list) const {
  const EdgeEnds edge = joined(part_, pair.one), other = joined(part_, pair.other);
  const TwoEdges end(edge, other, x_);
  if (pair.volume * end.volume >= 0 && !end.are_nearer(2 * layer_)) return;
  const auto motion = [&](const Positions& to) {
    const auto middle = [&](const EdgeEnds& of) {
      return Vec3(0.5 * (to.row(of[0]) - q_.row(of[0]) + to.row(of[1]) - q_.row(of[1])).transpose());
    };
    return Vec3(middle(edge) - middle(other));
  };
  const double reach = std::min(reach_of_pair(motion(x_), motion(y_)), layer_) + layer_;
  TouchedEdges::add_edges(edge, other, reach, list);
}

void OwnSheetPoints::find(std::size_t index, std::vector<Contact>& list) const {
  const std::size_t points = pairs_.points.size();
  if (index < points) {
    add_point(pairs_.points[index], list);
  } else {
    add_edges(pairs_.edges[index - points], list);
  }
}

double OwnSheetPoints::share_to_impact(std::size_t index, double least) const {
  constexpr double deepest = 0.5;  // how deep a point that arrives may be in the layer, over its thickness
  if (index >= pairs_.points.size()) {
    const OwnSheet::EdgePair& pair = pairs_.edges[index - pairs_.points.size()];
    return TouchedEdges::share_to_impact(joined(part_, pair.one), joined(part_, pair.other), least);
  }
  const auto& [vertex, triangle, volume] = pairs_.points[index];
  const std::int32_t v = joined_vertex(part_, vertex);
  const Vec3 a = q_.row(v), b = x_.row(v);
  const std::optional<Entry> crossing = surface_.moving->first_crossing(std::span(&triangle, 1), a, b, least);
  if (!crossing) return 1;
  const double falls = way_into(*crossing, a, b);
  return falls > 0 ? std::max(0.0, crossing->share - (1 - deepest) * surface_.layer / falls) : 1;
}

}  // namespace supple
