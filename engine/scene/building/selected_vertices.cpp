#include "scene/building/selected_vertices.h"

#include <algorithm>
#include <map>

namespace supple {
namespace {

std::vector<std::int32_t> numbered_vertices(const Selection& s, const TetMesh& mesh) {
  std::vector<std::int32_t> result;
  for (const int number : s.vertices) {
    if (number <= mesh.rest.rows()) result.push_back(number - 1);
  }
  return result;
}

std::vector<std::int32_t> vertices_of_region(const Selection& s, const Body& body) {
  const TetMesh& mesh = body.description.mesh;
  const auto tag = std::find(body.regions.begin(), body.regions.end(), s.region) - body.regions.begin();
  std::vector<std::int32_t> result;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    if (mesh.regions[e] != tag) continue;
    for (int k = 0; k < 4; ++k) result.push_back(mesh.tets(e, k));
  }
  return result;
}

std::vector<std::int32_t> nearest_vertices(const Selection& s, const Bounds& box, const Positions& points) {
  std::vector<std::int32_t> result;
  for (const Vec3& relative : s.points) {
    const Vec3 at = box.lower + relative.cwiseProduct(box.extent());
    Eigen::Index nearest = 0;
    (points.rowwise() - at.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    result.push_back(static_cast<std::int32_t>(nearest));
  }
  return result;
}

// Returns the vertices in a box, ball or half space.
std::vector<std::int32_t> vertices_within(const Selection& s, const Bounds& box, const Positions& points) {
  const Vec3 extent = box.extent().cwiseMax(1e-300);
  std::vector<std::int32_t> result;
  for (std::int32_t v = 0; v < points.rows(); ++v) {
    const Vec3 point = points.row(v);
    const Vec3 relative = (point - box.lower).cwiseQuotient(extent);
    const Vec3 away = point - (box.lower + s.center.cwiseProduct(extent));
    bool in = false;
    // The box has a tolerance of a millionth, because a box that ends at 1 is meant to include vertices at 1.
    if (s.kind == Selection::Kind::box)
      in = (relative.array() >= s.lower.array() - 1e-6).all() && (relative.array() <= s.upper.array() + 1e-6).all();
    if (s.kind == Selection::Kind::sphere) in = away.norm() <= s.radius * box.extent().maxCoeff();
    if (s.kind == Selection::Kind::plane) in = away.dot(s.normal.normalized()) >= -1e-6 * box.extent().maxCoeff();
    if (in) result.push_back(v);
  }
  return result;
}

// Tells which vertices of a cloth are on its open border.
std::vector<char> on_border(const Triangles& triangles, Eigen::Index vertices) {
  std::map<VertexPair, int> count;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      VertexPair edge{triangles(t, k), triangles(t, (k + 1) % 3)};
      std::sort(edge.begin(), edge.end());
      ++count[edge];
    }
  }
  std::vector<char> border(std::size_t(vertices), 0);
  for (const auto& [edge, triangles_there] : count) {
    if (triangles_there == 1) border[std::size_t(edge[0])] = border[std::size_t(edge[1])] = 1;
  }
  return border;
}

}  // namespace

std::vector<std::int32_t> selected_vertices(const Selection& s, const Body& body) {
  const TetMesh& mesh = body.description.mesh;
  const Bounds box = bounds_of(body.unplaced);
  std::vector<std::int32_t> result = s.kind == Selection::Kind::vertices  ? numbered_vertices(s, mesh)
                                     : s.kind == Selection::Kind::region  ? vertices_of_region(s, body)
                                     : s.kind == Selection::Kind::nearest ? nearest_vertices(s, box, body.unplaced)
                                                                          : vertices_within(s, box, body.unplaced);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  if (s.border) {
    const std::vector<char> border = on_border(body.cloth.surface.triangles, mesh.rest.rows());
    std::erase_if(result, [&](std::int32_t v) { return border[std::size_t(v)] == 0; });
  }
  return result;
}

}  // namespace supple
