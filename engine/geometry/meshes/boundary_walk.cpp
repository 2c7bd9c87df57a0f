#include "geometry/meshes/boundary_walk.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace supple {

Vec3 closest_weights(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& point) {
  const Vec3 ab = b - a, ac = c - a, from_a = point - a, from_b = point - b, from_c = point - c;
  const double d1 = ab.dot(from_a), d2 = ac.dot(from_a);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(from_b), d4 = ac.dot(from_b);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double of_c = d1 * d4 - d3 * d2;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = ab.dot(from_c), d6 = ac.dot(from_c);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double of_b = d5 * d2 - d1 * d6;
  if (of_b <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double of_a = d3 * d6 - d5 * d4;
  const double to_c = d4 - d3, to_b = d5 - d6;
  if (of_a <= 0 && to_c >= 0 && to_b >= 0 && to_c + to_b > 0) return {0, to_b / (to_c + to_b), to_c / (to_c + to_b)};
  const double sum = of_a + of_b + of_c;
  if (!(sum > 0)) return {1, 0, 0};
  return {1 - of_b / sum - of_c / sum, of_b / sum, of_c / sum};
}

BoundaryWalk::BoundaryWalk(const TetMesh& mesh)
    : rest_(mesh.rest), faces_(boundary_faces(mesh.tets)), around_(std::size_t(mesh.rest.rows())) {
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    for (int k = 0; k < 3; ++k) around_[std::size_t(faces_(f, k))].push_back(static_cast<std::int32_t>(f));
  }
  find_ways_out(mesh.tets);
}

void BoundaryWalk::find_ways_out(const Tetrahedra& tets) {
  std::vector<std::vector<std::int32_t>> beside(around_.size());
  for (Eigen::Index e = 0; e < tets.rows(); ++e) {
    for (int k = 0; k < 4; ++k) {
      for (int j = 0; j < 4; ++j) {
        if (j != k) beside[std::size_t(tets(e, k))].push_back(tets(e, j));
      }
    }
  }
  way_out_.assign(around_.size(), -1);
  std::vector<std::int32_t> reached;
  for (std::size_t v = 0; v < around_.size(); ++v) {
    if (around_[v].empty()) continue;
    way_out_[v] = static_cast<std::int32_t>(v);
    reached.push_back(way_out_[v]);
  }
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (const std::int32_t next : beside[std::size_t(reached[i])]) {
      if (way_out_[std::size_t(next)] >= 0) continue;
      way_out_[std::size_t(next)] = way_out_[std::size_t(reached[i])];
      reached.push_back(next);
    }
  }
}

BoundaryPoint BoundaryWalk::on(std::int32_t face, const Vec3& point) const {
  const auto corner = [&](int k) -> Vec3 { return rest_.row(faces_(face, k)); };
  BoundaryPoint found;
  found.face = face;
  found.weights = closest_weights(corner(0), corner(1), corner(2), point);
  found.point = found.weights[0] * corner(0) + found.weights[1] * corner(1) + found.weights[2] * corner(2);
  found.distance = (point - found.point).norm();
  return found;
}

void BoundaryWalk::try_faces_around(std::int32_t vertex, const Vec3& point, BoundaryPoint& best) const {
  for (const std::int32_t face : around_[std::size_t(vertex)]) {
    const BoundaryPoint found = on(face, point);
    if (found.distance < best.distance) best = found;
  }
}

BoundaryPoint BoundaryWalk::from(std::span<const std::int32_t> vertices, const Vec3& point) const {
  BoundaryPoint best;
  for (const std::int32_t vertex : vertices) {
    const std::int32_t start = way_out_[std::size_t(vertex)];
    if (start >= 0) try_faces_around(start, point, best);
  }
  for (std::int32_t before = -1; best.face != before;) {
    before = best.face;
    for (int k = 0; k < 3; ++k) try_faces_around(faces_(before, k), point, best);
  }
  return best;
}

Vec3 BoundaryWalk::normal(std::int32_t face) const {
  const auto corner = [&](int k) -> Vec3 { return rest_.row(faces_(face, k)); };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
}

double BoundaryWalk::mean_edge(std::int32_t face) const {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += (rest_.row(faces_(face, k)) - rest_.row(faces_(face, (k + 1) % 3))).norm();
  return sum / 3;
}

}  // namespace supple
