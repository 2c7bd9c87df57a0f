#include "app/bench/linked_rings.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace supple {

// The sum of Gauss' integral over all pairs of edges is the number of times that two closed curves go around each other
// (Arai 2013, "A rigorous numerical algorithm for computing the linking number of links", equation 2).
double linking_number(const std::vector<Vec3>& one, const std::vector<Vec3>& other) {
  const auto angle = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                 b.dot(c) * a.norm() + c.dot(a) * b.norm());
  };
  double sum = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    for (std::size_t j = 0; j < other.size(); ++j) {
      const Vec3 &p = one[i], &q = one[(i + 1) % one.size()], &r = other[j], &s = other[(j + 1) % other.size()];
      sum += angle(r - p, s - p, s - q) + angle(r - p, s - q, r - q);
    }
  }
  return sum / (4 * std::numbers::pi);
}

std::vector<Vec3> middle_line_of_ring(const Positions& rest, const Positions& x) {
  constexpr int sectors = 24;
  std::vector<Vec3> line(sectors, Vec3::Zero());
  std::vector<int> count(sectors, 0);
  const Vec3 center = rest.colwise().mean().transpose();
  const Eigen::RowVector3d extent = rest.colwise().maxCoeff() - rest.colwise().minCoeff();
  const int across = extent[2] > extent[0] ? 2 : 0;
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    const double turn = std::atan2(rest(v, 1) - center[1], rest(v, across) - center[across]) / (2 * std::numbers::pi);
    const auto sector = static_cast<std::size_t>((turn + 1) * sectors) % sectors;
    line[sector] += x.row(v).transpose();
    ++count[sector];
  }
  for (int s = 0; s < sectors; ++s) line[s] /= count[s];
  return line;
}

}  // namespace supple
