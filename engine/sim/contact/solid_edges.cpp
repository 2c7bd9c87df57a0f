#include "sim/contact/solid_edges.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "sim/contact/usual_depth.h"
#include "sim/model/joined_model.h"

namespace supple {
namespace {

// The sine of the least angle between the way from one solid to another and the faces beside both ridges. Boxes that
// lie flat on each other would otherwise have contacts at edges that say what their corners say already.
constexpr double least_slope = 0.1;

std::array<Vec3, 3> corners_of(const Part& part, const SurfaceWork::Parts::Surface& surface, std::int32_t triangle,
                               const Positions& x) {
  const auto place = [&](int k) { return Vec3(x.row(joined_vertex(part, surface.triangles(triangle, k)))); };
  return {place(0), place(1), place(2)};
}

// Tells whether a unit vector points out of the solid between the two faces of a ridge, and away from both by an angle
// of at least this sine. edge: the number of the ridge among the surface's edges; along: the way from its lower vertex
// to the higher one.
bool leads_out(const Part& part, const SurfaceWork::Parts::Surface& surface, std::size_t edge, const Vec3& along,
               const Vec3& way, const Positions& x, double least) {
  const auto& [one, other] = surface.edge_faces[edge];
  if (one < 0) return false;
  const auto normal = [&](std::int32_t triangle) {
    const auto [a, b, c] = corners_of(part, surface, triangle, x);
    return Vec3((b - a).cross(c - a).normalized());
  };
  const Vec3 first = normal(one), second = normal(other), unit = along.normalized();
  return first.cross(second).dot(unit) > 0 && first.cross(way).dot(unit) >= least &&
         way.cross(second).dot(unit) >= least && way.dot(first + second) > 0;
}

}  // namespace

bool SolidEdges::are_asked(const Model& model, const StepInputs& inputs, std::size_t meeting) {
  const Meeting& own = inputs.meetings[meeting];
  if (own.is_own() || !model.parts[own.surface].solid) return false;
  return !model.parts[own.points].solid || own.points < own.surface;
}

SolidEdges::SolidEdges(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                       const Positions& y, const Positions& x, const Work& work)
    : TouchedEdges(model, inputs, inputs.meetings[meeting], q, y, x, work,
                   0.5 * work.surfaces[inputs.meetings[meeting].points].layer),
      own_part_(model.parts[meeting_.points]),
      own_(work.surfaces[meeting_.points]),
      of_sheet_(!own_part_.solid) {
  if (!of_sheet_) deepest_at_impact_ = usual_depth(size_);
}

template <class Visit>
void SolidEdges::visit_ridges_near(const EdgeEnds& edge, double margin, const Visit& visit) const {
  if (of_sheet_) return visit_edges_near(edge, margin, visit);
  if (surface_.sharp_edges.empty()) return;
  visit_edges_near(edge, margin, [&](std::size_t other) {
    if (std::ranges::binary_search(surface_.sharp_edges, std::int32_t(other))) visit(other);
  });
}

// Returns the unit vector along the shortest way between two edges that points out of the solid; nothing where the
// other edge is no ridge, or where they are not closest to each other there.
std::optional<Vec3> SolidEdges::way_out(std::size_t edge, std::size_t ridge, const TwoEdges& pair,
                                        const Positions& x) const {
  const double least = of_sheet_ ? 0 : least_slope;
  const Vec3 across = pair.across.normalized();
  for (const Vec3& way : {across, Vec3(-across)}) {
    if (!leads_out(part_, surface_, ridge, pair.other_way, way, x, least)) continue;
    if (of_sheet_ || leads_out(own_part_, own_, edge, pair.way, -way, x, least)) return way;
  }
  return std::nullopt;
}

// Tells whether an edge passes through one of the two faces of a ridge.
bool SolidEdges::passes_face(const EdgeEnds& edge, std::size_t ridge) const {
  const Vec3 from = x_.row(edge[0]), to = x_.row(edge[1]), way = to - from;
  return std::ranges::any_of(surface_.edge_faces[ridge], [&](std::int32_t face) {
    const auto [a, b, c] = corners_of(part_, surface_, face, x_);
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.dot(from - a) * normal.dot(to - a) >= 0) return false;
    const double ab = way.dot((a - from).cross(b - from)), bc = way.dot((b - from).cross(c - from)),
                 ca = way.dot((c - from).cross(a - from));
    return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
  });
}

// An edge that is below the ridge and did not come there in this step is held only where it passes through a face:
// what is on the far side of a thin part is below the ridge, too.
void SolidEdges::add_ridge(std::size_t own, std::size_t ridge, double reach, std::vector<Contact>& list) const {
  const EdgeEnds &edge = own_.edges[own], &other = surface_.edges[ridge];
  const TwoEdges start(edge, other, q_), end(edge, other, x_);
  const bool may_cross = start.volume * end.volume < 0;
  if (!may_cross && !end.are_nearer(std::max(reach, surface_.edge))) return;
  if (!end.are_lines()) return;
  const bool crosses = may_cross && edge_passage(edge, other, q_, x_).has_value();
  if (!crosses && !end.meet(0)) return;
  const std::optional<Vec3> normal = way_out(own, ridge, end, x_);
  if (!normal) return;
  const double above = normal->dot(end.from - end.other_from);
  const bool is_below = above < 0 && !crosses;
  if (above > reach || (is_below && !passes_face(edge, ridge))) return;
  double field = is_below ? above - layer_ : reach;
  if (start.meet(0)) {
    const std::optional<Vec3> before = way_out(own, ridge, start, q_);
    if (before) field = before->dot(start.from - start.other_from) - layer_;
  }
  add_pair(edge, other, end, *normal, field, list);
}

void SolidEdges::find(std::size_t index, std::vector<Contact>& list) const {
  const std::size_t own = own_edge(index);
  const EdgeEnds& edge = own_.edges[own];
  const double free_reach = reach_of_edge(edge);
  const double reach = of_sheet_ ? std::min(free_reach, layer_) + layer_ : free_reach;
  visit_ridges_near(edge, reach, [&](std::size_t ridge) { add_ridge(own, ridge, reach, list); });
}

double SolidEdges::share_to_impact(std::size_t index, double least) const {
  const std::size_t own = own_edge(index);
  const EdgeEnds& edge = own_.edges[own];
  visit_ridges_near(edge, 0, [&](std::size_t ridge) {
    const EdgeEnds& other = surface_.edges[ridge];
    const double impact = TouchedEdges::share_to_impact(edge, other, least);
    if (impact >= least) return;
    const TwoEdges start(edge, other, q_);
    const std::optional<Vec3> before = way_out(own, ridge, start, q_);
    if (before && before->dot(start.from - start.other_from) > 0) least = impact;
  });
  return least;
}

}  // namespace supple
