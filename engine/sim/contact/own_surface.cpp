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

// Computes what pairs of a vertex and a triangle are asked about, over a step.
struct OwnSurface::Motion {
  // Describes how a vertex moves before a triangle.
  struct Approach {
    double motion;   // beside the triangle [m]
    double nearest;  // a lower bound of their distance on the way [m]
  };

  const Triangles& triangles;
  const Positions &q, &x;

  // Returns how a vertex approaches a triangle. What moves by m between two places that are a and b away comes no
  // nearer than (a + b - m) / 2.
  Approach approach(std::int32_t v, std::int32_t t) const {
    const Vec3 before = q.row(v).transpose() - centroid(q, t), after = x.row(v).transpose() - centroid(x, t);
    const double motion = (after - before).norm();
    return {motion, 0.5 * (before.norm() + after.norm() - motion) - std::sqrt(std::max(reach(q, t), reach(x, t)))};
  }
  // Returns how far a vertex begins above a triangle's plane, negative behind it [m].
  double above_at_start(std::int32_t v, std::int32_t t) const { return above(q, v, t); }
  double above_at_end(std::int32_t v, std::int32_t t) const { return above(x, v, t); }
  Vec3 normal_at_start(std::int32_t t) const { return unit_normal(q, triangles, t); }

 private:
  Vec3 centroid(const Positions& p, std::int32_t t) const {
    const Vec3 a = p.row(triangles(t, 0)), b = p.row(triangles(t, 1)), c = p.row(triangles(t, 2));
    return (a + b + c) / 3;
  }
  // Returns the largest squared distance of a triangle's corners from its centroid [m^2].
  double reach(const Positions& p, std::int32_t t) const {
    const Vec3 middle = centroid(p, t);
    double squared = 0;
    for (int k = 0; k < 3; ++k)
      squared = std::max(squared, (p.row(triangles(t, k)).transpose() - middle).squaredNorm());
    return squared;
  }
  double above(const Positions& p, std::int32_t v, std::int32_t t) const {
    return unit_normal(p, triangles, t).dot(p.row(v).transpose() - centroid(p, t));
  }
};

OwnSurface::OwnSurface(Tetrahedra tets, const MovingSurface& moving, const Positions& rest, double size)
    : paths_(std::move(tets), moving.triangles(), rest),
      triangles_(moving.triangles()),
      centroids_(triangles_.rows(), 3) {
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
  parts_ = moving.solid_parts([&](std::int32_t v, std::vector<std::int32_t>& found) {
    for (const std::int32_t neighbour : paths_.neighbours(v)) {
      const std::span<const std::int32_t> around = moving.around(neighbour);
      found.insert(found.end(), around.begin(), around.end());
    }
  });
}

double OwnSurface::most_cosine(double above) const { return above < -shallow_ ? against : same_way; }

bool OwnSurface::are_near_at_rest(std::int32_t a, std::int32_t b, double distance) const {
  const double reach = distance + radius_[std::size_t(a)] + radius_[std::size_t(b)];
  return (centroids_.row(a) - centroids_.row(b)).squaredNorm() <= reach * reach;
}

// Returns the unit vector in which the surface faces at a vertex: along the sum of the areas of the triangles there.
Vec3 OwnSurface::facing(const MovingSurface& moving, const Positions& x, std::int32_t vertex) const {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t t : moving.around(vertex)) {
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

bool OwnSurface::touches(MovingSurface& moving, const Positions& q, const Positions& x, const Vec3& carried) const {
  constexpr double tangled = 0.01;
  return meets(moving, q, x, carried) && paths_.inverted_share(q) <= tangled;
}

bool OwnSurface::meets(MovingSurface& moving, const Positions& q, const Positions& x, const Vec3& carried) const {
  const Motion motion{triangles_, q, x};
  bool may_begin_inside = false;
  const auto comes_through = [&](std::int32_t v, std::int32_t t) {
    const double above = motion.above_at_start(v, t);
    if (above <= -deep_) return false;
    const Motion::Approach approach = motion.approach(v, t);
    const auto may_touch = [&] { return !(facing(moving, q, v).dot(motion.normal_at_start(t)) > most_cosine(above)); };
    if (above < 0) {
      may_begin_inside |= approach.nearest <= deep_ && may_touch();
      return false;
    }
    return approach.nearest <= 0 && motion.above_at_end(v, t) < 0 && may_touch() && passes(q, x, v, t) &&
           !is_collapsed_around(q, v, t) && !is_collapsed_around(x, v, t);
  };
  if (moving.any_own_pair(parts_, q, x, deep_, carried, same_way, comes_through)) return true;
  if (!may_begin_inside) return false;
  Pairs pairs;
  find_pairs(moving, q, q, 0, Vec3::Zero(), pairs);
  moving.set_start(q);
  for (std::size_t i = 0; i < pairs.vertices.size(); ++i)
    if (place_around(moving, q, pairs.vertices[i], pairs.of(i))) return true;
  return false;
}

bool OwnSurface::overlaps(MovingSurface& moving, const Positions& q) const {
  return touches(moving, q, q, Vec3::Zero());
}

void OwnSurface::find_pairs(const MovingSurface& moving, const Positions& q, const Positions& x, double margin,
                            const Vec3& carried, Pairs& pairs) const {
  struct Pair {
    std::int32_t vertex, triangle;
    double motion;
  };
  std::vector<Pair> found;
  const Motion motion{triangles_, q, x};
  moving.any_own_pair(parts_, q, x, std::max(margin, deep_), carried, same_way, [&](std::int32_t v, std::int32_t t) {
    const double above = motion.above_at_start(v, t);
    if (above <= -deep_) return false;
    const Motion::Approach approach = motion.approach(v, t);
    if (approach.nearest > (above < 0 ? deep_ : margin)) return false;
    if (facing(moving, q, v).dot(motion.normal_at_start(t)) > most_cosine(above)) return false;
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
