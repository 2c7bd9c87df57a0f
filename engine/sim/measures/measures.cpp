#include "sim/measures/measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "geometry/shapes/shape_pieces.h"
#include "geometry/shapes/triangle_in_shape.h"
#include "sim/elements/element_kernels.h"

namespace supple {
namespace {

// Returns the value above which the values with a given total weight lie. Takes pairs of value and weight, and sorts
// only the largest ones.
double weighted_top(std::vector<std::pair<double, double>>& pairs, double weight_above) {
  for (std::size_t count = pairs.size() / 256 + 64;; count *= 2) {
    const auto end = pairs.begin() + static_cast<std::ptrdiff_t>(std::min(count, pairs.size()));
    std::partial_sort(pairs.begin(), end, pairs.end(), std::greater<>());
    double above = 0, value = 0;
    for (auto pair = pairs.begin(); pair != end; ++pair) {
      value = pair->first;
      above += pair->second;
      if (above > weight_above) return value;
    }
    if (end == pairs.end()) return value;
  }
}

}  // namespace

bool is_tangled(const Model& model, const Positions& x) {
  const Deformation shape = deformation(model, x);
  return shape.inverted + shape.collapsed > 0;
}

Deformation deformation(const Model& model, const Positions& x, Threads* threads) {
  std::vector<std::pair<double, double>> stretches;  // stretch, weight
  std::vector<double> inverted, collapsed;           // their volumes
  stretches.reserve(model.elements);
  std::vector<double> all_largest(std::size_t(model.blocks) * block_width), all_ratios(all_largest.size());
  run_chunks(threads, static_cast<int>(model.chunks.size()), long(model.elements) * 4, [&](int c) {
    const std::size_t first = std::size_t(model.chunks[c].first_block) * block_width;
    element_kernels().stretches(model.chunk(c), x.data(), &all_largest[first], &all_ratios[first]);
  });
  double total = 0, volume = 0;
  int solids = 0;
  for (const Model::ChunkRange& range : model.chunks) {
    const std::size_t lanes = std::size_t(range.blocks) * block_width;
    const double *largest = &all_largest[std::size_t(range.first_block) * block_width],
                 *ratio = &all_ratios[std::size_t(range.first_block) * block_width];
    const bool solid = range.kind == ElementKind::tetrahedron;
    if (range.is_arm) continue;  // its element was counted
    // The weight of a tetrahedron is its volume, of a triangle its area, of a spring its length.
    const std::size_t fields = fields_of(range.kind), weight_field = range.kind == ElementKind::spring ? 0 : fields - 1;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (model.element_of_lane[range.first_block * std::size_t(block_width) + lane] < 0) continue;  // padding
      const std::size_t block = lane / block_width * fields + weight_field;
      const double weight = model.field[range.first_field + block * block_width + lane % block_width];
      if (solid && ratio[lane] < 0) inverted.push_back(weight);
      if (solid && std::abs(ratio[lane]) < without_volume) collapsed.push_back(weight);
      if (solid) volume += weight;
      solids += solid;
      stretches.emplace_back(largest[lane], weight);
      total += weight;
    }
  }
  Deformation result;
  if (solids > 0) {
    const double least = 1e-6 * volume / solids;
    const auto counted = [least](const std::vector<double>& volumes) {
      return static_cast<int>(std::count_if(volumes.begin(), volumes.end(), [least](double v) { return v > least; }));
    };
    result.inverted = counted(inverted);
    result.collapsed = counted(collapsed);
  }
  result.stretch = weighted_top(stretches, 0.001 * total);
  return result;
}

double jiggle(const Model& model, const Positions& x, const Eigen::Isometry3d& motion) {
  double furthest2 = 0;
  for (int v = 0; v < model.vertices; ++v) {
    furthest2 = std::max(furthest2, (motion * Vec3(model.rest.row(v)) - Vec3(x.row(v))).squaredNorm());
  }
  return std::sqrt(furthest2) / model.size;
}

namespace {

// Tells whether no point of a triangle is deeper in a shape than `known`. The distances at the triangle's centre and,
// down to some level, at the centres of its quarters show that. certainty: Shape::certainty.
bool certainly_no_deeper(const ShapeProbe& probe, double certainty, const Vec3& a, const Vec3& b, const Vec3& c,
                         double known, int levels, QueryMemory& near) {
  const Vec3 center = (a + b + c) / 3;
  const double radius = std::max({(a - center).norm(), (b - center).norm(), (c - center).norm()});
  const double needed = probe.is_exact() ? radius - known : radius;
  if (probe.certain_distance(center, near) >= needed || certainty * probe.distance(center, near) >= needed) return true;
  if (levels == 0) return false;
  const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
  const auto clear = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
    return certainly_no_deeper(probe, certainty, p, q, r, known, levels - 1, near);
  };
  return clear(ab, bc, ca) && clear(a, ab, ca) && clear(ab, b, bc) && clear(ca, bc, c);
}

constexpr Eigen::Index triangles_a_group = 32;  // consecutive ones, which mostly are neighbours

struct Ball {
  Vec3 center;
  double radius;
};

// Returns a ball around the corners of some triangles.
Ball ball_around(const Positions& x, const Triangles& triangles, Eigen::Index first, Eigen::Index end) {
  Bounds box;
  for (Eigen::Index t = first; t < end; ++t)
    for (int k = 0; k < 3; ++k) box.include(x.row(triangles(t, k)));
  return {box.center(), 0.5 * box.diagonal()};
}

// Calls visit(corners, descent, depth_at) for the triangles that may be deeper in a shape than `known`, in the shape's
// own frame. Depth is looked for in each piece of a union, and depth_at(point) measures it in the whole.
template <class Visit>
void visit_deep_triangles(const Shape& shape, const Eigen::Isometry3d& pose, const Positions& x,
                          const Triangles& triangles, const double& known, const Visit& visit) {
  const Eigen::Isometry3d to_local = pose.inverse();
  const ShapeProbe probe(shape);
  const std::vector<ShapePiece> pieces = pieces_of(shape);
  std::vector<ShapeProbe> probes;
  std::vector<double> certainties;
  std::vector<int> levels;  // of quarters; near holes of a surface, inside and outside are told apart less surely
  for (const ShapePiece& piece : pieces) {
    probes.emplace_back(piece.shape);
    certainties.push_back(piece.shape.certainty());
    levels.push_back(probes.back().is_exact() || probes.back().remembered() == nullptr ? 2 : 0);
  }
  std::vector<QueryMemory> near(pieces.size() + 1);
  const auto depth_at = [&](const Vec3& p) { return -probe.closest(p, near.back()).distance; };
  const auto is_clear = [&](const Ball& ball) {
    const Vec3 center = to_local * ball.center;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (certainties[i] * probes[i].distance(center, near[i]) < ball.radius) return false;
    return true;
  };
  for (Eigen::Index first = 0; first < triangles.rows(); first += triangles_a_group) {
    const Eigen::Index end = std::min(first + triangles_a_group, triangles.rows());
    if (is_clear(ball_around(x, triangles, first, end))) continue;
    for (Eigen::Index t = first; t < end; ++t) {
      TriangleCorners corner;
      for (int k = 0; k < 3; ++k) corner[k] = to_local * Vec3(x.row(triangles(t, k)));
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (certainly_no_deeper(probes[i], certainties[i], corner[0], corner[1], corner[2], known, levels[i], near[i]))
          continue;
        visit(corner, TriangleInShape(probes[i], pieces[i].half_thickness, corner, near[i]).descend(), depth_at);
      }
    }
  }
}

// Returns the largest depth in one shape, or `known` where none is larger.
double deepest_in(const Shape& shape, const Eigen::Isometry3d& pose, const Positions& x, const Triangles& triangles,
                  double known) {
  double deepest = known;
  visit_deep_triangles(shape, pose, x, triangles, deepest,
                       [&](const TriangleCorners& corner, const TriangleInShape::Descent& least, const auto& depth_at) {
                         const auto look = [&](const Vec3& p, double distance) {
                           if (distance < -deepest) deepest = std::max(deepest, depth_at(p));
                         };
                         for (int k = 0; k < least.count; ++k)
                           look(least.places[k].point, least.places[k].surface.distance);
                         for (int k = 0; k < 3; ++k) look(corner[k], least.at_corners);
                       });
  return deepest;
}

}  // namespace

std::vector<double> penetrations(const std::vector<Collider>& colliders, const std::vector<ColliderMotion>& motions,
                                 const Positions& x, const Triangles& triangles) {
  std::vector<double> depths;
  for (std::size_t c = 0; c < colliders.size(); ++c)
    depths.push_back(deepest_in(colliders[c].shape, motions[c].end, x, triangles, 0));
  return depths;
}

double penetration(const std::vector<Collider>& colliders, const std::vector<ColliderMotion>& motions,
                   const Positions& x, const Triangles& triangles) {
  double deepest = 0;
  for (std::size_t c = 0; c < colliders.size(); ++c)
    deepest = deepest_in(colliders[c].shape, motions[c].end, x, triangles, deepest);
  return deepest;
}

std::vector<Vec3> deep_places(const Collider& collider, const Eigen::Isometry3d& pose, const Positions& x,
                              const Triangles& triangles, double depth) {
  std::vector<Vec3> places;
  visit_deep_triangles(collider.shape, pose, x, triangles, depth,
                       [&](const TriangleCorners&, const TriangleInShape::Descent& least, const auto& depth_at) {
                         for (int k = 0; k < least.count; ++k) {
                           const TrianglePlace& place = least.places[k];
                           const bool deeper = place.surface.distance < std::min(-depth, least.at_corners);
                           if (deeper && depth_at(place.point) > depth) places.push_back(pose * place.point);
                         }
                       });
  return places;
}

}  // namespace supple
