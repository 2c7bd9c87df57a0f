#include "sim/contact/own_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/triangles/point_passage.h"
#include "sim/contact/usual_depth.h"

namespace supple {
namespace {

Vec3 unit_normal(const Positions& x, const Triangles& triangles, std::int32_t t) {
  const Vec3 first = x.row(triangles(t, 0)), second = x.row(triangles(t, 1)), third = x.row(triangles(t, 2));
  const Vec3 normal = (second - first).cross(third - first);
  const double length = normal.norm();
  return length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero());
}

}  // namespace

// Holds what pairs of a vertex and a triangle are asked about, over a step.
struct OwnSurface::Motion {
  // Describes how a vertex moves before a triangle.
  struct Approach {
    double motion;   // beside the triangle [m]
    double nearest;  // a lower bound of their distance on the way [m]
  };

  const Positions &q, &x;
  Positions start, end;        // the triangles' centroids [m]
  std::vector<double> radius;  // by triangle: how far its corners are from its centroid at most [m]
  Positions normal;            // of the triangles at the start

  Motion(const Triangles& triangles, const Positions& from, const Positions& to)
      : q(from), x(to), start(triangles.rows(), 3), end(triangles.rows(), 3), normal(triangles.rows(), 3) {
    radius.reserve(std::size_t(triangles.rows()));
    for (std::int32_t t = 0; t < triangles.rows(); ++t) {
      double squared = 0;
      const auto centroid = [&](const Positions& p) {
        const Vec3 a = p.row(triangles(t, 0)), b = p.row(triangles(t, 1)), c = p.row(triangles(t, 2));
        const Vec3 middle = (a + b + c) / 3;
        squared =
            std::max({squared, (a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()});
        return middle;
      };
      start.row(t) = centroid(q);
      end.row(t) = centroid(x);
      radius.push_back(std::sqrt(squared));
      normal.row(t) = unit_normal(q, triangles, t);
    }
  }

  // Returns how a vertex approaches a triangle. What moves by m between two places that are a and b away comes no
  // nearer than (a + b - m) / 2.
  Approach approach(std::int32_t v, std::int32_t t) const {
    const Vec3 before = (q.row(v) - start.row(t)).transpose(), after = (x.row(v) - end.row(t)).transpose();
    const double motion = (after - before).norm();
    return {motion, 0.5 * (before.norm() + after.norm() - motion) - radius[std::size_t(t)]};
  }
  // Returns how far a vertex begins above a triangle's plane, negative behind it [m].
  double above_at_start(std::int32_t v, std::int32_t t) const { return normal.row(t).dot(q.row(v) - start.row(t)); }
  double above_at_end(std::int32_t v, std::int32_t t, const Triangles& triangles) const {
    return unit_normal(x, triangles, t).dot((x.row(v) - end.row(t)).transpose());
  }
};

OwnSurface::OwnSurface(Tetrahedra tets, Triangles triangles, const Positions& rest, double size)
    : paths_(std::move(tets), triangles, rest), triangles_(std::move(triangles)), centroids_(triangles_.rows(), 3) {
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    centroids_.row(t) = (rest.row(triangles_(t, 0)) + rest.row(triangles_(t, 1)) + rest.row(triangles_(t, 2))) / 3;
    double radius = 0;
    for (int k = 0; k < 3; ++k) {
      radius = std::max(radius, (rest.row(triangles_(t, k)) - centroids_.row(t)).norm());
    }
    radius_.push_back(radius);
  }
  edge_ = mean_edge(triangles_, rest);
  shallow_ = usual_depth(size);
  deep_ = std::max(least_deep * size, std::min(most_deep * size, 0.5 * edge_));
  around_begin_.assign(static_cast<std::size_t>(rest.rows()) + 1, 0);
  for (Eigen::Index i = 0; i < triangles_.size(); ++i) ++around_begin_[std::size_t(triangles_.data()[i]) + 1];
  for (std::size_t v = 1; v < around_begin_.size(); ++v) around_begin_[v] += around_begin_[v - 1];
  around_.resize(std::size_t(triangles_.size()));
  std::vector<std::int32_t> next(around_begin_.begin(), around_begin_.end() - 1);
  for (std::int32_t t = 0; t < triangles_.rows(); ++t)
    for (int k = 0; k < 3; ++k) around_[std::size_t(next[std::size_t(triangles_(t, k))]++)] = t;
}

double OwnSurface::most_cosine(double above) const { return above < -shallow_ ? against : same_way; }

bool OwnSurface::are_neighbours(std::int32_t vertex, std::int32_t triangle) const {
  for (int k = 0; k < 3; ++k)
    if (paths_.are_neighbours(vertex, triangles_(triangle, k))) return true;
  return false;
}

bool OwnSurface::are_near_at_rest(std::int32_t a, std::int32_t b, double distance) const {
  const double reach = distance + radius_[std::size_t(a)] + radius_[std::size_t(b)];
  return (centroids_.row(a) - centroids_.row(b)).squaredNorm() <= reach * reach;
}

// Returns the unit vector in which the surface faces at a vertex: along the sum of the areas of the triangles there.
Vec3 OwnSurface::facing(const Positions& x, std::int32_t vertex) const {
  Vec3 sum = Vec3::Zero();
  for (std::int32_t i = around_begin_[std::size_t(vertex)]; i < around_begin_[std::size_t(vertex) + 1]; ++i) {
    const std::int32_t t = around_[std::size_t(i)];
    const Vec3 first = x.row(triangles_(t, 0)), second = x.row(triangles_(t, 1)), third = x.row(triangles_(t, 2));
    sum += (second - first).cross(third - first);
  }
  const double length = sum.norm();
  return length > 0 ? Vec3(sum / length) : Vec3(Vec3::Zero());
}

bool OwnSurface::is_collapsed_around(const Positions& x, std::int32_t vertex, std::int32_t triangle) const {
  if (paths_.is_collapsed_at(x, vertex)) return true;
  for (int k = 0; k < 3; ++k)
    if (paths_.is_collapsed_at(x, triangles_(triangle, k))) return true;
  return false;
}

bool OwnSurface::passes(const Positions& q, const Positions& x, std::int32_t vertex, std::int32_t triangle) const {
  const Vec3 a = q.row(vertex), b = x.row(vertex);
  SeenTriangle seen;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t corner = triangles_(triangle, int(k));
    seen.start[k] = q.row(corner).transpose() - a;
    seen.end[k] = x.row(corner).transpose() - b;
  }
  const double roundoff = 1e-15 * a.cwiseAbs().cwiseMax(b.cwiseAbs()).maxCoeff();
  return first_passage(seen, roundoff, 1).has_value();
}

bool OwnSurface::touches(const MovingSurface& moving, const Positions& q, const Positions& x,
                         const Vec3& carried) const {
  constexpr double tangled = 0.01;
  return meets(moving, q, x, carried) && paths_.inverted_share(q) <= tangled;
}

bool OwnSurface::meets(const MovingSurface& moving, const Positions& q, const Positions& x, const Vec3& carried) const {
  const Motion motion(triangles_, q, x);
  bool may_begin_inside = false;
  const auto comes_through = [&](std::int32_t v, std::int32_t t) {
    const double above = motion.above_at_start(v, t);
    if (above <= -deep_ || are_neighbours(v, t)) return false;
    const Motion::Approach approach = motion.approach(v, t);
    if (above < 0) {
      may_begin_inside |= approach.nearest <= deep_ && !(facing(q, v).dot(motion.normal.row(t)) > most_cosine(above));
      return false;
    }
    return approach.nearest <= 0 && motion.above_at_end(v, t, triangles_) < 0 &&
           !(facing(q, v).dot(motion.normal.row(t)) > same_way) && passes(q, x, v, t) &&
           !is_collapsed_around(q, v, t) && !is_collapsed_around(x, v, t);
  };
  if (moving.any_own_pair(deep_, carried, same_way, comes_through)) return true;
  if (!may_begin_inside) return false;
  Pairs pairs;
  find_pairs(moving, q, q, 0, Vec3::Zero(), pairs);
  for (std::size_t i = 0; i < pairs.vertices.size(); ++i)
    if (place_around(moving, q, pairs.vertices[i], pairs.of(i))) return true;
  return false;
}

bool OwnSurface::overlaps(const MovingSurface& moving, const Positions& q) const {
  return touches(moving, q, q, Vec3::Zero());
}

void OwnSurface::find_pairs(const MovingSurface& moving, const Positions& q, const Positions& x, double margin,
                            const Vec3& carried, Pairs& pairs) const {
  struct Pair {
    std::int32_t vertex, triangle;
    double motion;
  };
  std::vector<Pair> found;
  const Motion motion(triangles_, q, x);
  moving.any_own_pair(std::max(margin, deep_), carried, same_way, [&](std::int32_t v, std::int32_t t) {
    const double above = motion.above_at_start(v, t);
    if (above <= -deep_) return false;
    const Motion::Approach approach = motion.approach(v, t);
    if (approach.nearest > (above < 0 ? deep_ : margin) || are_neighbours(v, t)) return false;
    if (facing(q, v).dot(motion.normal.row(t)) > most_cosine(above)) return false;
    found.push_back({v, t, approach.motion});
    return false;
  });
  std::ranges::sort(found, {}, [](const Pair& pair) { return std::pair(pair.vertex, pair.triangle); });
  pairs = {};
  for (const Pair& pair : found) {
    if (pairs.vertices.empty() || pairs.vertices.back() != pair.vertex) {
      pairs.vertices.push_back(pair.vertex);
      pairs.begin.push_back(static_cast<std::int32_t>(pairs.triangles.size()));
      pairs.motion.push_back(0);
    }
    pairs.triangles.push_back(pair.triangle);
    pairs.motion.back() = std::max(pairs.motion.back(), pair.motion);
  }
  pairs.begin.push_back(static_cast<std::int32_t>(pairs.triangles.size()));
}

std::optional<MovingSurface::Place> OwnSurface::place_around(const MovingSurface& moving, const Positions& q,
                                                             std::int32_t vertex,
                                                             std::span<const std::int32_t> triangles) const {
  const Vec3 p = q.row(vertex);
  const MovingSurface::Takes behind = [&](std::int32_t t) {
    return unit_normal(q, triangles_, t).dot(p - q.row(triangles_(t, 0)).transpose()) < 0;
  };
  std::optional<MovingSurface::Place> place = moving.closest_at_start(triangles, p, deep_, behind);
  if (!place) return place;
  const std::optional<std::int32_t> element = paths_.element_at_end(q, place->triangle, place->point, p);
  if (!element || paths_.has_neighbour(*element, vertex) || is_collapsed_around(q, vertex, place->triangle))
    return std::nullopt;
  place->distance = -std::abs(place->distance);
  return place;
}

}  // namespace supple
