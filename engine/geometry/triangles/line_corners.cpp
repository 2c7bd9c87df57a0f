#include "geometry/triangles/line_corners.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace supple {
namespace {

class CornerSearch {
 public:
  CornerSearch(const std::vector<std::int32_t>& row, const Positions& points, const FeatureLimits& limits)
      : points_(points), closed_(row.front() == row.back()), limits_(limits) {
    line_.vertices = row;
    line_.along.push_back(0);
    for (std::size_t i = 1; i < row.size(); ++i)
      line_.along.push_back(line_.along.back() + (points.row(row[i]) - points.row(row[i - 1])).norm());
    for (std::size_t i = 0; i < row.size(); ++i) turns_.push_back(turn_at(i));
  }

  // Tells whether the line turns sharply at a vertex, and at no vertex near it more sharply.
  bool is_sharp(std::size_t i) const {
    if (!(turns_[i] > limits_.corner)) return false;
    const std::size_t count = turns_.size() - 1;
    for (const bool ahead : {false, true}) {
      double way = 0;
      for (std::size_t j = i, steps = 0; steps < count; ++steps) {
        if (!closed_ && j == (ahead ? count : 0)) break;
        const std::size_t segment = ahead ? j % count : (j + count - 1) % count;
        way += line_.along[segment + 1] - line_.along[segment];
        if (way > 0.5 * limits_.window) break;
        j = ahead ? j + 1 : (j + count - 1) % count;
        if (closed_) j %= count;
        if (j != i && (turns_[j] > turns_[i] || (turns_[j] == turns_[i] && j < i))) return false;
      }
    }
    return true;
  }

  // Returns the vertex of a closed line that is furthest from one of its vertices, along the line.
  std::size_t opposite_of(std::size_t vertex) const {
    std::size_t best = 0;
    double furthest = 0;
    for (std::size_t i = 0; i + 1 < line_.along.size(); ++i) {
      const double ahead = std::abs(line_.along[i] - line_.along[vertex]);
      const double way = std::min(ahead, line_.length() - ahead);
      if (way > furthest) {
        furthest = way;
        best = i;
      }
    }
    return best;
  }

 private:
  Vec3 point(double along) const {
    const double length = line_.length();
    if (closed_) along -= length * std::floor(along / length);
    return point_of(line_, along, points_);
  }

  double turn_at(std::size_t i) const {
    const double here = line_.along[i], length = line_.length();
    const double reach =
        closed_ ? std::min(limits_.window, length / 4) : std::min({limits_.window, here, length - here});
    if (!(reach > 0)) return 0;
    const Vec3 middle = points_.row(line_.vertices[i]);
    const Vec3 before = middle - point(here - reach), after = point(here + reach) - middle;
    return std::atan2(before.cross(after).norm(), before.dot(after));
  }

  const Positions& points_;
  const bool closed_;
  const FeatureLimits limits_;
  FeatureLine line_;  // a closed row is one line here, from a vertex back to itself
  std::vector<double> turns_;
};

}  // namespace

std::vector<std::size_t> line_corners(const std::vector<std::int32_t>& row, const Positions& points,
                                      const std::vector<char>& is_corner, const FeatureLimits& limits) {
  const bool closed = row.front() == row.back();
  const CornerSearch search(row, points, limits);
  std::vector<std::size_t> corners;
  for (std::size_t i = 0; i + (closed ? 1 : 0) < row.size(); ++i) {
    const bool is_end = !closed && (i == 0 || i + 1 == row.size());
    if (is_end || is_corner[std::size_t(row[i])] || search.is_sharp(i)) corners.push_back(i);
  }
  if (!closed || corners.size() >= 2) return corners;
  if (corners.empty()) corners.push_back(0);
  corners.push_back(search.opposite_of(corners[0]));
  std::ranges::sort(corners);
  return corners;
}

}  // namespace supple
