#include "app/bench/knotted_bar.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>

namespace supple {
namespace {

// Describes where one edge of a closed curve passes over another one, seen along the third axis. Places are counted in
// edges from the beginning.
struct Crossing {
  double under, over;
};

std::optional<Crossing> crossing_of(const std::vector<Vec3>& curve, std::size_t i, std::size_t j) {
  const Vec3 &a = curve[i], &c = curve[j];
  const Vec3 u = curve[(i + 1) % curve.size()] - a, v = curve[(j + 1) % curve.size()] - c, apart = c - a;
  const double across = u.x() * v.y() - u.y() * v.x();
  if (across == 0) return std::nullopt;
  const double s = (apart.x() * v.y() - apart.y() * v.x()) / across;
  const double t = (apart.x() * u.y() - apart.y() * u.x()) / across;
  if (!(s >= 0 && s < 1 && t >= 0 && t < 1)) return std::nullopt;
  const double here = double(i) + s, there = double(j) + t;
  return a.z() + s * u.z() > c.z() + t * v.z() ? Crossing{there, here} : Crossing{here, there};
}

// Returns the curve with its ends led away and joined far outside. It is turned arbitrarily, so that crossings, seen
// along the third axis, hardly ever lie exactly at ends of edges.
std::vector<Vec3> closed(const std::vector<Vec3>& line) {
  Bounds box;
  for (const Vec3& point : line) box.include(point);
  const double far = 10 * box.diagonal();
  const Vec3 begin = (line[0] - line[1]).normalized(), end = (line.back() - line[line.size() - 2]).normalized();
  std::vector<Vec3> curve = line;
  curve.push_back(line.back() + far * end);
  curve.push_back(line.back() + far * (end + Vec3::UnitY()));
  curve.push_back(line.front() + far * (begin + Vec3::UnitY()));
  curve.push_back(line.front() + far * begin);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.37, Vec3(0.61, 0.29, 0.73).normalized()).toRotationMatrix();
  for (Vec3& point : curve) point = turn * point;
  return curve;
}

}  // namespace

int knot_determinant(const std::vector<Vec3>& line) {
  const std::vector<Vec3> curve = closed(line);
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    for (std::size_t j = i + 2; j < curve.size(); ++j) {
      if (i == 0 && j + 1 == curve.size()) continue;
      if (const auto crossing = crossing_of(curve, i, j)) crossings.push_back(*crossing);
    }
  }
  std::ranges::sort(crossings, {}, &Crossing::under);
  const auto count = static_cast<Eigen::Index>(crossings.size());
  if (count < 2) return 1;
  Eigen::MatrixXd colors = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto before = std::ranges::lower_bound(crossings, crossings[std::size_t(k)].over, {}, &Crossing::under);
    colors(k, (before - crossings.begin()) % count) += 2;
    colors(k, k) -= 1;
    colors(k, (k + 1) % count) -= 1;
  }
  return static_cast<int>(
      std::lround(std::abs(colors.topLeftCorner(count - 1, count - 1).partialPivLu().determinant())));
}

std::vector<Vec3> middle_line_of_bar(const Triangles& triangles, const Positions& rest, const Positions& x) {
  constexpr int shells = 80;
  std::vector<std::vector<std::int32_t>> around(std::size_t(rest.rows()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) around[std::size_t(triangles(t, k))].push_back(triangles(t, (k + 1) % 3));
  std::vector<double> distance(std::size_t(rest.rows()), infinity);
  using Waiting = std::pair<double, std::int32_t>;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting;
  Eigen::Index end = 0;
  rest.col(0).maxCoeff(&end);
  waiting.emplace(distance[std::size_t(end)] = 0, std::int32_t(end));
  while (!waiting.empty()) {
    const auto [so_far, v] = waiting.top();
    waiting.pop();
    if (so_far > distance[std::size_t(v)]) continue;
    for (const std::int32_t next : around[std::size_t(v)]) {
      const double there = so_far + (rest.row(next) - rest.row(v)).norm();
      if (!(there < distance[std::size_t(next)])) continue;
      distance[std::size_t(next)] = there;
      waiting.emplace(there, next);
    }
  }
  double longest = 0;
  for (const double one : distance)
    if (one < infinity) longest = std::max(longest, one);
  std::vector<Vec3> sums(shells, Vec3::Zero());
  std::vector<int> counts(shells, 0);
  for (std::size_t v = 0; v < distance.size(); ++v) {
    if (!(distance[v] < infinity)) continue;
    const auto shell = std::min(std::size_t(shells * distance[v] / longest), std::size_t(shells - 1));
    sums[shell] += x.row(Eigen::Index(v)).transpose();
    ++counts[shell];
  }
  std::vector<Vec3> line;
  for (std::size_t s = 0; s < shells; ++s)
    if (counts[s] > 0) line.push_back(sums[s] / counts[s]);
  return line;
}

}  // namespace supple
