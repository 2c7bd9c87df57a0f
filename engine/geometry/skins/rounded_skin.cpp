#include "geometry/skins/rounded_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "geometry/skins/shape_surface.h"
#include "geometry/skins/skin_graph.h"
#include "geometry/skins/skin_middles.h"
#include "geometry/triangles/split_triangle.h"

namespace supple {
namespace {

// Names an edge by its ends, the smaller number first.
std::uint64_t edge_name(std::int32_t a, std::int32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return std::uint64_t(low) << 32 | std::uint64_t(high);
}

// Returns the normal at each vertex, of unit length or 0. Vertices that share a number of Skin::smooth share theirs.
Positions vertex_normals(const Skin& skin) {
  const Positions& points = skin.rest.points;
  const Eigen::Index named = skin.smooth.empty() ? points.rows() : 1 + *std::ranges::max_element(skin.smooth);
  Positions normals = Positions::Zero(named, 3);
  const auto shared = [&](Eigen::Index v) {
    return skin.smooth.empty() ? v : Eigen::Index(skin.smooth[std::size_t(v)]);
  };
  for (Eigen::Index t = 0; t < skin.rest.triangles.rows(); ++t) {
    const auto corner = [&](int k) -> Vec3 { return points.row(skin.rest.triangles(t, k)); };
    const Vec3 face = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (int k = 0; k < 3; ++k) normals.row(shared(skin.rest.triangles(t, k))) += face.transpose();
  }
  for (Eigen::Index v = 0; v < named; ++v) {
    const double length = normals.row(v).norm();
    if (length > 0) normals.row(v) /= length;
  }
  Positions result(points.rows(), 3);
  for (Eigen::Index v = 0; v < points.rows(); ++v) result.row(v) = normals.row(shared(v));
  return result;
}

// Cuts the edges of a skin once.
class RoundingPass {
 public:
  RoundingPass(Skin& skin, const Roundness& roundness, const ExactSurface* exact)
      : skin_(skin), roundness_(roundness), exact_(exact), node_of_(skin_graph(skin.rest).node_of) {
    if (exact_ == nullptr) return;
    to_shape_ = exact_->from_shape.inverse();
    to_scale_ = std::cbrt(to_shape_.linear().determinant());
  }

  // Cuts, and appends the ends of the edges in whose middle new vertices lie.
  void run(std::vector<std::array<std::int32_t, 2>>& ends) {
    find_edges();
    bool cuts = false;
    for (auto& [name, edge] : edges_) cuts |= edge.cut = is_cut(edge);
    if (cuts) cut();
    for (const Added& added : added_) ends.push_back({added.a, added.b});
  }

 private:
  struct Edge {
    std::int32_t from, to;  // skin vertices; where it is a crease, those of one side
    int triangles = 0;
    bool crease = false;
    bool cut = false;
    Vec3 middle = Vec3::Zero();  // where the surface should be
  };

  Vec3 point(std::int32_t v) const { return skin_.rest.points.row(v); }

  // Lists the edges, each once for both sides of a crease.
  void find_edges() {
    normals_ = vertex_normals(skin_);
    const auto alike = [this](std::int32_t a, std::int32_t b) {
      constexpr double same = 0.9999;  // cosine of an angle below a degree
      return a == b || normals_.row(a).dot(normals_.row(b)) > same;
    };
    for (Eigen::Index t = 0; t < skin_.rest.triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        std::int32_t from = skin_.rest.triangles(t, k), to = skin_.rest.triangles(t, (k + 1) % 3);
        if (node_of_[std::size_t(from)] > node_of_[std::size_t(to)]) std::swap(from, to);
        Edge& edge =
            edges_.try_emplace(edge_name(node_of_[std::size_t(from)], node_of_[std::size_t(to)]), Edge{from, to})
                .first->second;
        ++edge.triangles;
        edge.crease = edge.crease || !alike(edge.from, from) || !alike(edge.to, to);
      }
    }
  }

  // Decides whether an edge is cut, and where its middle then lies.
  bool is_cut(Edge& edge) const {
    const Vec3 a = point(edge.from), b = point(edge.to), straight = 0.5 * (a + b);
    const double length = (b - a).norm();
    if (length < roundness_.edge) return false;
    // A middle that is farther away than this lies on another part of the surface, which faces that of the ends.
    constexpr double furthest = 0.25;  // over the edge's length
    edge.middle = on_curve(edge, a, b);
    if (exact_ != nullptr) {
      // The skin's own normals tell where it is too flat to be worth a look at the shape, which takes longer.
      const bool flat = (edge.middle - straight).norm() < 0.5 * roundness_.off;
      if (flat && !is_near_paint(edge, length)) return false;
      edge.middle = on_shape(straight, length);
    }
    const double off = (edge.middle - straight).norm();
    const bool bent = off > roundness_.off;
    if (bent && (off > furthest * length || (exact_ != nullptr && !turns_evenly(a, edge.middle, b, length)))) {
      edge.middle = straight;
      return bends_paint(edge, length);
    }
    return bent || bends_paint(edge, length);
  }

  Vec3 on_shape(const Vec3& straight, double length) const {
    return exact_->from_shape * onto_surface(exact_->shape, to_shape_ * straight, 0.5 * length * to_scale_);
  }

  // Tells whether the ends of an edge and its middle lie on the shape, with normals at the ends that are alike, and a
  // normal in the middle that is about their mean. It is not across a sharp edge of the shape. Triangles cut off such
  // an edge: halved, they would make it a row of scallops.
  bool turns_evenly(const Vec3& a, const Vec3& middle, const Vec3& b, double length) const {
    const auto lies_off = [&](const Vec3& place) {
      return std::abs(exact_->shape.distance(to_shape_ * place)) > 0.5 * roundness_.off * to_scale_;
    };
    if (lies_off(a) || lies_off(middle) || lies_off(b)) return false;
    const auto normal = [&](const Vec3& place) -> Vec3 {
      return exact_->shape.gradient(to_shape_ * place, 0.02 * length * to_scale_).normalized();
    };
    constexpr double sharp = 0.34, evenly = 0.95;  // cosines of 70 and 18 degrees
    const Vec3 at_a = normal(a), at_b = normal(b);
    return at_a.dot(at_b) > sharp && normal(middle).dot((at_a + at_b).normalized()) > evenly;
  }

  // Returns the middle of the cubic curve whose control points next to the ends lie in the planes through the ends that
  // are perpendicular to the normals there.
  Vec3 on_curve(const Edge& edge, const Vec3& a, const Vec3& b) const {
    if (edge.crease || edge.triangles != 2) return 0.5 * (a + b);
    const Vec3 at_a = normals_.row(edge.from), at_b = normals_.row(edge.to);
    return 0.5 * (a + b) - ((b - a).dot(at_a) * at_a + (a - b).dot(at_b) * at_b) / 8;
  }

  double nearest_border(const Edge& edge, std::size_t layer) const {
    return std::min(std::abs(skin_.paint[std::size_t(edge.from)][layer]),
                    std::abs(skin_.paint[std::size_t(edge.to)][layer]));
  }

  // Tells whether the border of a layer may cross an edge.
  bool is_near_paint(const Edge& edge, double length) const {
    for (std::size_t layer = 0; layer < exact_->shape.paint.size(); ++layer)
      if (nearest_border(edge, layer) < length * to_scale_) return true;
    return false;
  }

  // Tells whether the border of a layer runs near an edge's middle, and is elsewhere than where the distances at the
  // ends would put it.
  bool bends_paint(const Edge& edge, double length) const {
    if (exact_ == nullptr) return false;
    for (std::size_t layer = 0; layer < exact_->shape.paint.size(); ++layer) {
      const double from = skin_.paint[std::size_t(edge.from)][layer], to = skin_.paint[std::size_t(edge.to)][layer];
      if (nearest_border(edge, layer) > length * to_scale_) continue;
      const double there = distance(exact_->shape.paint[layer].area, to_shape_ * edge.middle);
      if (std::abs(there) < 0.5 * length * to_scale_ &&
          std::abs(there - 0.5 * (from + to)) > roundness_.off * to_scale_)
        return true;
    }
    return false;
  }

  void cut() {
    const auto length2 = [this](std::int32_t a, std::int32_t b) { return (point(a) - point(b)).squaredNorm(); };
    const Triangles whole = skin_.rest.triangles;
    // All new vertices come first, because the shorter diagonal depends on their places.
    std::vector<std::array<std::int32_t, 3>> middles;
    for (Eigen::Index t = 0; t < whole.rows(); ++t) {
      middles.push_back({});
      for (int k = 0; k < 3; ++k) middles.back()[std::size_t(k)] = middle_of(whole(t, k), whole(t, (k + 1) % 3));
    }
    append_vertices();
    std::vector<CornerNumbers> parts;
    for (Eigen::Index t = 0; t < whole.rows(); ++t)
      split_triangle({whole(t, 0), whole(t, 1), whole(t, 2)}, middles[std::size_t(t)], length2, parts);
    skin_.rest.triangles.resize(Eigen::Index(parts.size()), 3);
    for (std::size_t t = 0; t < parts.size(); ++t)
      skin_.rest.triangles.row(Eigen::Index(t)) << parts[t][0], parts[t][1], parts[t][2];
  }

  // Returns the number of the vertex in the middle of an edge; -1 where it is not cut.
  std::int32_t middle_of(std::int32_t a, std::int32_t b) {
    const Edge& edge = edges_.at(edge_name(node_of_[std::size_t(a)], node_of_[std::size_t(b)]));
    if (!edge.cut) return -1;
    const auto number = static_cast<std::int32_t>(std::size_t(skin_.rest.points.rows()) + added_.size());
    const auto [at, is_new] = middle_number_.try_emplace(edge_name(a, b), number);
    if (is_new) added_.push_back({a, b, edge.middle});
    return at->second;
  }

  struct Added {
    std::int32_t a, b;  // the ends of its edge
    Vec3 place;
  };

  void append_vertices() {
    const Eigen::Index before = skin_.rest.points.rows();
    SkinMiddles looks(skin_);
    skin_.rest.points.conservativeResize(before + Eigen::Index(added_.size()), 3);
    for (std::size_t i = 0; i < added_.size(); ++i) {
      skin_.rest.points.row(before + Eigen::Index(i)) = added_[i].place.transpose();
      looks.append(std::size_t(added_[i].a), std::size_t(added_[i].b));
      paint_exactly(added_[i].place);
    }
  }

  // Gives the last vertex the paint of its place, where the exact surface is known.
  void paint_exactly(const Vec3& place) {
    if (exact_ == nullptr) return;
    for (std::size_t layer = 0; layer < exact_->shape.paint.size(); ++layer)
      skin_.paint.back()[layer] = static_cast<float>(distance(exact_->shape.paint[layer].area, to_shape_ * place));
  }

  Skin& skin_;
  const Roundness roundness_;
  const ExactSurface* exact_;
  Eigen::Affine3d to_shape_;
  double to_scale_ = 1;                                            // lengths in the shape's frame over those here
  const std::vector<std::int32_t> node_of_;                        // by skin vertex (skin_graph.h)
  Positions normals_;                                              // by skin vertex
  std::unordered_map<std::uint64_t, Edge> edges_;                  // by the nodes at their ends
  std::unordered_map<std::uint64_t, std::int32_t> middle_number_;  // by the skin vertices at their ends
  std::vector<Added> added_;
};

}  // namespace

std::vector<std::array<std::int32_t, 2>> round_off(Skin& skin, const Roundness& roundness, const ExactSurface* exact) {
  constexpr int passes = 3;
  constexpr Eigen::Index most = 1'000'000;  // triangles
  std::vector<std::array<std::int32_t, 2>> ends;
  for (int pass = 0; pass < passes && 4 * skin.rest.triangles.rows() <= most; ++pass) {
    const std::size_t before = ends.size();
    RoundingPass(skin, roundness, exact).run(ends);
    if (ends.size() == before) break;
  }
  return ends;
}

}  // namespace supple
