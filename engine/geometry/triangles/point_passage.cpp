#include "geometry/triangles/point_passage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {
namespace {

// Describes the triangle at one time: a corner and the two edges that start there.
struct Frame {
  Vec3 corner, to_second, to_third;

  Vec3 area() const { return to_second.cross(to_third); }
};

Frame frame_of(const std::array<Vec3, 3>& corners) {
  return {corners[0], corners[1] - corners[0], corners[2] - corners[0]};
}

Frame between(const Frame& start, const Frame& end, double t) {
  const double s = 1 - t;
  return {s * start.corner + t * end.corner, s * start.to_second + t * end.to_second,
          s * start.to_third + t * end.to_third};
}

// Holds a cubic on [0, 1] by its Bernstein coefficients: it has no values beyond the least and the largest of them.
struct Cubic {
  std::array<double, 4> c;

  double at(double t) const {
    const double s = 1 - t;
    return s * s * (s * c[0] + 3 * t * c[1]) + t * t * (3 * s * c[2] + t * c[3]);
  }
  double slope(double t) const {
    const double s = 1 - t;
    return 3 * (s * s * (c[1] - c[0]) + 2 * s * t * (c[2] - c[1]) + t * t * (c[3] - c[2]));
  }
};

// Returns the point's height above the triangle times twice the triangle's area [m^3].
Cubic height(const Frame& start, const Frame& end) {
  const Vec3 first = start.area(), last = end.area();
  const Vec3 mixed = start.to_second.cross(end.to_third) + end.to_second.cross(start.to_third);
  return {{-start.corner.dot(first), -(end.corner.dot(first) + start.corner.dot(mixed)) / 3,
           -(start.corner.dot(last) + end.corner.dot(mixed)) / 3, -end.corner.dot(last)}};
}

struct Times {
  std::array<double, 4> t;
  int count;
};

// Lists 0, the cubic's extrema before `latest`, and `latest`, in their order. Between them the cubic rises or falls all
// the way.
Times ends_of_slopes(const Cubic& cubic, double latest) {
  const double d0 = cubic.c[1] - cubic.c[0], d1 = cubic.c[2] - cubic.c[1], d2 = cubic.c[3] - cubic.c[2];
  Times times{{0}, 1};
  // The slope is a t^2 + 2 b t + d0. This form of its roots loses no digits.
  const double a = d0 - 2 * d1 + d2, b = d1 - d0, inside = b * b - a * d0;
  if (inside > 0) {
    const double q = -(b + std::copysign(std::sqrt(inside), b));
    const double one = d0 / q, other = q / a;
    for (const double t : {std::min(one, other), std::max(one, other)})
      if (t > 0 && t < latest) times.t[std::size_t(times.count++)] = t;
  }
  times.t[std::size_t(times.count++)] = latest;
  return times;
}

// Returns a root between two times: the cubic is not negative at `above`, and is negative at `below`. Newton's steps
// are taken while they stay between the times that are known; the last sixty steps halve what is left.
double root_between(const Cubic& cubic, double above, double below) {
  double t = 0.5 * (above + below);
  for (int i = 0; i < 90; ++i) {
    const double value = cubic.at(t);
    if (value == 0) break;
    (value > 0 ? above : below) = t;
    double next = t - value / cubic.slope(t);
    if (i >= 30 || !(next > above && next < below)) next = 0.5 * (above + below);
    const bool is_found = std::abs(next - t) <= std::numeric_limits<double>::epsilon();
    t = next;
    if (is_found) break;
  }
  return t;
}

// Returns the passage at a time at which the point lies in the triangle's plane, if it lies in the triangle.
std::optional<Passage> passage_at(const Frame& start, const Frame& end, double share) {
  constexpr double beside = 1e-6;  // share of the triangle's size
  const Frame now = between(start, end, share);
  const Vec3 area = now.area();
  const double squared = area.squaredNorm();
  const double v = -now.corner.cross(now.to_third).dot(area) / squared;
  const double w = -now.to_second.cross(now.corner).dot(area) / squared;
  if (!(v >= -beside && w >= -beside && v + w <= 1 + beside)) return std::nullopt;  // also without area
  const Vec3 weights = Vec3(1 - v - w, v, w).cwiseMax(0);
  return Passage{share, weights / weights.sum(), area / std::sqrt(squared)};
}

}  // namespace

std::optional<Passage> first_passage(const SeenTriangle& triangle, double roundoff, double latest) {
  const Frame start = frame_of(triangle.start), end = frame_of(triangle.end);
  const Cubic cubic = height(start, end);
  const auto [least, largest] = std::minmax_element(cubic.c.begin(), cubic.c.end());
  if (*least >= 0) return std::nullopt;
  const auto larger = [](const Vec3& a, const Vec3& b) {
    return std::sqrt(std::max(a.squaredNorm(), b.squaredNorm()));
  };
  constexpr double of_products = 1e-15;  // by which the cubic's values may be wrong, as a share of its products
  const double noise = (roundoff + of_products * larger(start.corner, end.corner)) *
                       larger(start.to_second, end.to_second) * larger(start.to_third, end.to_third);
  if (*largest < -noise) return std::nullopt;

  // A point that is behind comes to the front where its height is no longer negative, and one that is in front comes
  // to the back where it is negative beyond doubt; so what is nearly zero makes no passages of its own.
  const Times times = ends_of_slopes(cubic, latest);
  bool is_behind = cubic.c[0] < -noise;
  double in_front = 0;  // the last of the times at which the point was seen in front
  for (int i = 0; i < times.count; ++i) {
    const double t = times.t[std::size_t(i)], value = cubic.at(t);
    if (value >= 0) {
      is_behind = false;
      in_front = t;
    } else if (!is_behind && value < -noise) {
      const double share = cubic.at(in_front) <= 0 ? in_front : root_between(cubic, in_front, t);
      if (const auto passage = passage_at(start, end, share)) return passage;
      is_behind = true;
    }
  }
  return std::nullopt;
}

}  // namespace supple
