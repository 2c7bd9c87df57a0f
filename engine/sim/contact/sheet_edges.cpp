#include "sim/contact/sheet_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace supple {
namespace {

using Edge = SurfaceWork::Parts::Edge;

// Describes two edges at one time.
struct TwoEdges {
  Vec3 from, other_from;  // where they begin [m]
  Vec3 way, other_way;    // to where they end [m]
  Vec3 across;            // the product of their ways [m^2]
  double volume;          // six times that of the tetrahedron of their ends [m^3]

  TwoEdges(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d)
      : from(a), other_from(c), way(b - a), other_way(d - c), across(way.cross(other_way)) {
    volume = (from - other_from).dot(across);
  }
  TwoEdges(const Edge& one, const Edge& other, const Positions& x)
      : TwoEdges(x.row(one[0]), x.row(one[1]), x.row(other[0]), x.row(other[1])) {}

  // Tells whether their lines are far from parallel, and so have closest places.
  bool are_lines() const {
    constexpr double least_sine = 0.05;
    return across.squaredNorm() > least_sine * least_sine * way.squaredNorm() * other_way.squaredNorm();
  }
  // Tells whether the lines are nearer to each other than this [m].
  bool are_nearer(double distance) const { return volume * volume < distance * distance * across.squaredNorm(); }
  // Return the shares of the edges at which their lines are closest.
  double share() const { return (other_from - from).cross(other_way).dot(across) / across.squaredNorm(); }
  double other_share() const { return (other_from - from).cross(way).dot(across) / across.squaredNorm(); }
  // Tells whether both places are on the edges, or beyond by so much of their lengths.
  bool meet(double beyond) const {
    if (!are_lines()) return false;
    const double s = share(), t = other_share(), end = 1 + beyond;
    return s >= -beyond && s <= end && t >= -beyond && t <= end;
  }
};

// Returns two edges at a share of the way from q to x.
TwoEdges at_share(const Edge& one, const Edge& other, const Positions& q, const Positions& x, double share) {
  const auto place = [&](std::int32_t v) { return Vec3(((1 - share) * q.row(v) + share * x.row(v)).transpose()); };
  return {place(one[0]), place(one[1]), place(other[0]), place(other[1])};
}

// Returns the first share of the way from q to x at which two edges pass through each other. The volume is a cubic
// function of the share; two roots in one interval are not found.
std::optional<double> passage(const Edge& one, const Edge& other, const Positions& q, const Positions& x) {
  constexpr int intervals = 8, halvings = 27;
  constexpr double beyond = 1e-6;
  double before = TwoEdges(one, other, q).volume;
  for (int k = 1; k <= intervals; ++k) {
    double low = double(k - 1) / intervals, high = double(k) / intervals;
    const double after = at_share(one, other, q, x, high).volume;
    if (before * after < 0) {
      for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (low + high);
        (before * at_share(one, other, q, x, middle).volume > 0 ? low : high) = middle;
      }
      if (at_share(one, other, q, x, low).meet(beyond)) return low;
    }
    before = after;
  }
  return std::nullopt;
}

}  // namespace

bool SheetEdges::are_asked(const Model& model, const StepInputs& inputs, std::size_t meeting) {
  const Meeting& own = inputs.meetings[meeting];
  return !own.is_own() && own.points < own.surface && !model.parts[own.points].solid && !model.parts[own.surface].solid;
}

SheetEdges::SheetEdges(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                       const Positions& y, const Positions& x, const Work& work)
    : TouchedSurface(model, inputs, inputs.meetings[meeting], q, y, x, work),
      own_(work.surfaces[meeting_.points]),
      layer_(0.5 * std::min(own_.layer, surface_.layer)) {}

// An edge is in the boxes of all triangles that have it, so that one of them is enough.
template <class Visit>
void SheetEdges::visit_edges_near(const Edge& edge, double margin, const Visit& visit) const {
  surface_.moving->visit_triangles_near({q_.row(edge[0]), q_.row(edge[1])}, {x_.row(edge[0]), x_.row(edge[1])},
                                        surface_.carried, margin, [&](std::int32_t t) {
                                          const auto first = surface_.edge_begin[std::size_t(t)],
                                                     end = surface_.edge_begin[std::size_t(t) + 1];
                                          for (auto e = first; e < end; ++e) visit(surface_.edges[std::size_t(e)]);
                                        });
}

// Edges that pass through each other twice in a step are taken as if they did not.
void SheetEdges::find(std::size_t index, std::vector<Contact>& list) const {
  constexpr double least_weight = 1e-4;  // a stencil has no weights of 0
  const Edge& edge = own_.edges[index];
  double way = 0;
  for (const std::int32_t v : edge)
    way = std::max(way, ((x_.row(v) - q_.row(v)).transpose() - surface_.carried).norm());
  const double reach = std::min(reach_at(edge[0], way), layer_) + layer_;
  visit_edges_near(edge, reach, [&](const Edge& other) {
    const TwoEdges start(edge, other, q_), end(edge, other, x_);
    const bool may_cross = start.volume * end.volume < 0;
    if (!may_cross && !end.are_nearer(reach)) return;
    if (!end.are_lines()) return;
    const bool crosses = may_cross && passage(edge, other, q_, x_).has_value();
    if (!crosses && !(end.are_nearer(reach) && end.meet(0))) return;
    const double side = (crosses ? start.volume : end.volume) >= 0 ? 1 : -1;
    const double s = std::clamp(end.share(), least_weight, 1 - least_weight),
                 t = std::clamp(end.other_share(), least_weight, 1 - least_weight);
    const ContactStencil stencil = stencil_of<4>({edge[0], edge[1], other[0], other[1]}, {1 - s, s, t - 1, -t});
    if (stencil.free == 0) return;
    const double field = start.meet(0) ? std::abs(start.volume) / start.across.norm() - layer_ : reach;
    add(stencil, edge[0], side * end.across.normalized(), field, list, layer_);
  });
}

double SheetEdges::share_to_impact(std::size_t index, double least) const {
  constexpr double deepest = 0.5;  // of the layer, for an edge that arrives
  const Edge& edge = own_.edges[index];
  visit_edges_near(edge, 0, [&](const Edge& other) {
    if (TwoEdges(edge, other, q_).volume * TwoEdges(edge, other, x_).volume >= 0) return;
    const std::optional<double> share = passage(edge, other, q_, x_);
    if (!share || *share >= least) return;
    const TwoEdges then = at_share(edge, other, q_, x_, *share);
    const auto way = [&](const Edge& of, double part) {
      return Vec3(((1 - part) * (x_.row(of[0]) - q_.row(of[0])) + part * (x_.row(of[1]) - q_.row(of[1]))).transpose());
    };
    const Vec3 pace = way(edge, then.share()) - way(other, then.other_share());
    const double falls = std::abs(then.across.normalized().dot(pace));
    if (falls > 0) least = std::min(least, std::max(0.0, *share - (1 - deepest) * layer_ / falls));
  });
  return least;
}

}  // namespace supple
