#include "geometry/meshes/mesh.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include "base/disjoint_sets.h"

namespace supple {
namespace {

// Lists the face opposite to each vertex, oriented outward for a positive element.
constexpr int opposite_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

struct FaceUse {
  std::array<std::int32_t, 3> key;  // sorted vertices
  std::int32_t element;
  int face;
};

// Lists all faces, sorted by their keys and then by element. They are counted into their places by the first vertex of
// the key, which leaves few to be compared with each other.
std::vector<FaceUse> sorted_faces(const Tetrahedra& tets) {
  std::vector<FaceUse> unsorted;
  unsorted.reserve(static_cast<std::size_t>(tets.rows()) * 4);
  std::vector<std::size_t> begin(tets.rows() == 0 ? 2 : static_cast<std::size_t>(tets.maxCoeff()) + 2, 0);
  for (Eigen::Index e = 0; e < tets.rows(); ++e) {
    for (int face = 0; face < 4; ++face) {
      FaceUse use;
      for (int k = 0; k < 3; ++k) use.key[static_cast<std::size_t>(k)] = tets(e, opposite_face[face][k]);
      std::sort(use.key.begin(), use.key.end());
      use.element = static_cast<std::int32_t>(e);
      use.face = face;
      ++begin[static_cast<std::size_t>(use.key[0]) + 1];
      unsorted.push_back(use);
    }
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<FaceUse> uses(unsorted.size());
  std::vector<std::size_t> next = begin;
  for (const FaceUse& use : unsorted) uses[next[static_cast<std::size_t>(use.key[0])]++] = use;
  const auto before = [](const FaceUse& a, const FaceUse& b) {
    return std::tie(a.key[1], a.key[2], a.element) < std::tie(b.key[1], b.key[2], b.element);
  };
  for (std::size_t v = 0; v + 1 < begin.size(); ++v)
    std::sort(uses.begin() + std::ptrdiff_t(begin[v]), uses.begin() + std::ptrdiff_t(begin[v + 1]), before);
  return uses;
}

}  // namespace

double tet_volume(const TetMesh& mesh, Eigen::Index element) {
  const auto corner = [&](int k) -> Vec3 { return mesh.rest.row(mesh.tets(element, k)); };
  const Vec3 origin = corner(0);
  return (corner(1) - origin).dot((corner(2) - origin).cross(corner(3) - origin)) / 6;
}

MeshQuality quality(const TetMesh& mesh) {
  MeshQuality q;
  double smallest = 1e300;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    const double volume = tet_volume(mesh, e);
    q.volume += volume;
    smallest = std::min(smallest, volume);
    Vec3 normal[4];
    for (int face = 0; face < 4; ++face) {
      const Vec3 a = mesh.rest.row(mesh.tets(e, opposite_face[face][0]));
      const Vec3 b = mesh.rest.row(mesh.tets(e, opposite_face[face][1]));
      const Vec3 c = mesh.rest.row(mesh.tets(e, opposite_face[face][2]));
      normal[face] = (b - a).cross(c - a).normalized();
    }
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        const double angle = std::acos(std::clamp(-normal[i].dot(normal[j]), -1.0, 1.0)) * 180 / std::numbers::pi;
        q.smallest_dihedral = std::min(q.smallest_dihedral, angle);
        q.largest_dihedral = std::max(q.largest_dihedral, angle);
      }
    }
  }
  if (mesh.tets.rows() > 0) q.smallest_volume = smallest / (q.volume / static_cast<double>(mesh.tets.rows()));
  return q;
}

Triangles boundary_faces(const Tetrahedra& tets) {
  const std::vector<FaceUse> uses = sorted_faces(tets);
  std::vector<const FaceUse*> single;
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    while (end < uses.size() && uses[end].key == uses[i].key) ++end;
    if (end == i + 1) single.push_back(&uses[i]);
    i = end;
  }
  Triangles faces(static_cast<Eigen::Index>(single.size()), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const FaceUse& use = *single[static_cast<std::size_t>(f)];
    for (int k = 0; k < 3; ++k) faces(f, k) = tets(use.element, opposite_face[use.face][k]);
  }
  return faces;
}

double mean_edge(const Triangles& triangles, const Positions& points) {
  double sum = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) sum += (points.row(triangles(t, k)) - points.row(triangles(t, (k + 1) % 3))).norm();
  }
  return sum / std::max<double>(1, static_cast<double>(triangles.size()));
}

std::vector<char> inside_elements(const TetMesh& mesh, const Positions& points) {
  std::vector<char> inside(static_cast<std::size_t>(points.rows()), 0);
  if (inside.empty()) return inside;
  int axis = 0;  // along which the points are spread most, so that few lie beside each element
  bounds_of(points).extent().maxCoeff(&axis);
  std::vector<Eigen::Index> sorted(inside.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::sort(sorted.begin(), sorted.end(),
            [&](Eigen::Index a, Eigen::Index b) { return points(a, axis) < points(b, axis); });
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    Vec3 corners[4];
    for (int k = 0; k < 4; ++k) corners[k] = mesh.rest.row(mesh.tets(e, k)).transpose();
    const Vec3 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]).cwiseMin(corners[3]);
    const Vec3 high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]).cwiseMax(corners[3]);
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = corners[k + 1] - corners[0];
    const Mat3 to_weights = edges.inverse();
    auto at = std::lower_bound(sorted.begin(), sorted.end(), low[axis],
                               [&](Eigen::Index point, double value) { return points(point, axis) < value; });
    for (; at != sorted.end() && points(*at, axis) <= high[axis]; ++at) {
      const Vec3 p = points.row(*at).transpose();
      if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
      const Vec3 weights = to_weights * (p - corners[0]);
      if (weights.minCoeff() >= 0 && weights.sum() <= 1) inside[static_cast<std::size_t>(*at)] = 1;
    }
  }
  return inside;
}

std::vector<int> face_connected_pieces(const Tetrahedra& tets) {
  DisjointSets pieces(static_cast<std::size_t>(tets.rows()));
  const std::vector<FaceUse> uses = sorted_faces(tets);
  for (std::size_t i = 1; i < uses.size(); ++i) {
    if (uses[i].key == uses[i - 1].key)
      pieces.join(static_cast<std::size_t>(uses[i - 1].element), static_cast<std::size_t>(uses[i].element));
  }
  std::vector<int> label(pieces.size(), -1);
  int count = 0;
  for (std::size_t e = 0; e < pieces.size(); ++e) {
    const std::size_t first = pieces.of(e);
    if (label[first] < 0) label[first] = count++;
    label[e] = label[first];
  }
  return label;
}

Manifoldness manifoldness(const TetMesh& mesh) {
  Manifoldness result;
  const std::vector<int> pieces = face_connected_pieces(mesh.tets);
  for (int piece : pieces) result.pieces = std::max(result.pieces, piece + 1);

  const Triangles faces = boundary_faces(mesh.tets);
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  std::vector<std::vector<std::pair<std::int32_t, std::int32_t>>> around(static_cast<std::size_t>(mesh.rest.rows()));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = faces(f, k), b = faces(f, (k + 1) % 3), c = faces(f, (k + 2) % 3);
      edges.emplace_back(std::min(a, b), std::max(a, b));
      around[static_cast<std::size_t>(a)].emplace_back(b, c);
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end - i != 2) ++result.bad_edges;
    i = end;
  }
  // Around a manifold vertex, the opposite edges (b, c) form one closed loop.
  for (auto& fan : around) {
    if (fan.empty()) continue;
    std::size_t steps = 0;
    std::int32_t at = fan.front().first;
    do {
      const auto next = std::find_if(fan.begin(), fan.end(), [at](const auto& edge) { return edge.first == at; });
      if (next == fan.end()) break;
      at = next->second;
      ++steps;
    } while (at != fan.front().first && steps <= fan.size());
    if (steps != fan.size()) ++result.bad_vertices;
  }
  return result;
}

TetMesh submesh(const TetMesh& mesh, const std::vector<char>& keep) {
  std::vector<std::int32_t> renamed(static_cast<std::size_t>(mesh.rest.rows()), -1);
  Eigen::Index kept = 0;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    if (!keep[static_cast<std::size_t>(e)]) continue;
    ++kept;
    for (int k = 0; k < 4; ++k) renamed[static_cast<std::size_t>(mesh.tets(e, k))] = 0;
  }
  std::int32_t vertices = 0;
  for (std::int32_t& name : renamed) {
    if (name == 0) name = vertices++;
  }
  TetMesh result;
  result.rest.resize(vertices, 3);
  for (Eigen::Index v = 0; v < mesh.rest.rows(); ++v) {
    if (renamed[static_cast<std::size_t>(v)] >= 0)
      result.rest.row(renamed[static_cast<std::size_t>(v)]) = mesh.rest.row(v);
  }
  result.tets.resize(kept, 4);
  Eigen::Index row = 0;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    if (!keep[static_cast<std::size_t>(e)]) continue;
    for (int k = 0; k < 4; ++k) result.tets(row, k) = renamed[static_cast<std::size_t>(mesh.tets(e, k))];
    ++row;
    if (!mesh.regions.empty()) result.regions.push_back(mesh.regions[static_cast<std::size_t>(e)]);
  }
  return result;
}

void transform(TetMesh& mesh, double scale, const Vec3& offset) {
  mesh.rest = (scale * mesh.rest).rowwise() + offset.transpose();
}

}  // namespace supple
