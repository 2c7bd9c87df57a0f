#include "sim/model/bending.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace supple {
namespace {

// Describes a triangle as one of its edges sees it.
struct Flap {
  std::int32_t triangle;
  int edge;  // the edge from corner `edge` to the next one
  std::int32_t tip;
  double height;  // of the tip over the edge [m]
  double slope;   // length of the edge over the height
  double foot;    // where the foot of the height is: 0 at the edge's first vertex, 1 at its second one
};

using Edge = std::array<std::int32_t, 2>;  // the first vertex is the lower one

Eigen::Vector2d corner_of(const FlatTriangle& triangle, int corner) {
  if (corner == 0) return {0, 0};
  return {triangle.edges[corner - 1], triangle.edges[2 + corner - 1]};
}

Flap flap_of(const FlatTriangle& triangle, std::int32_t number, int edge) {
  int from = edge, to = (edge + 1) % 3;
  const int tip = (edge + 2) % 3;
  if (triangle.corner[from] > triangle.corner[to]) std::swap(from, to);
  const Eigen::Vector2d along = corner_of(triangle, to) - corner_of(triangle, from);
  const Eigen::Vector2d rise = corner_of(triangle, tip) - corner_of(triangle, from);
  const double length = along.norm(), height = 2 * triangle.area() / length;
  return {number, edge, triangle.corner[tip], height, length / height, rise.dot(along) / (length * length)};
}

std::map<Edge, std::vector<Flap>> flaps_by_edge(const std::vector<FlatTriangle>& triangles) {
  std::map<Edge, std::vector<Flap>> flaps;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int e = 0; e < 3; ++e) {
      Edge edge{triangles[t].corner[e], triangles[t].corner[(e + 1) % 3]};
      std::sort(edge.begin(), edge.end());
      flaps[edge].push_back(flap_of(triangles[t], static_cast<std::int32_t>(t), e));
    }
  }
  return flaps;
}

// Holds a linear function of the positions: vertices with their factors.
using Combination = std::vector<std::pair<std::int32_t, double>>;

// Calls visit(triangle, hinges) for each triangle. hinges: for each of its edges the part of K x that belongs to the
// triangle; empty at the border, where a free sheet is not bent across. Where more than two triangles meet at an edge,
// a hinge is the mean of those with each of the others.
template <class Visit>
void for_each_hinged(const std::vector<FlatTriangle>& triangles, const Visit& visit) {
  std::vector<std::array<Combination, 3>> hinges(triangles.size());
  for (const auto& [edge, flaps] : flaps_by_edge(triangles)) {
    for (const Flap& own : flaps) {
      Combination& k = hinges[std::size_t(own.triangle)][std::size_t(own.edge)];
      for (const Flap& other : flaps) {
        if (&other == &own) continue;
        // Of the angle a triangle has the part that its height has of both heights; half of it is its mean share.
        const double share = 2 * own.height / (own.height + other.height) / double(flaps.size() - 1);
        // K x = l ((tip - foot) / height + (other tip - other foot) / other height): two opposite unit vectors where
        // the hinge is flat, and 2 sin(angle/2) l in length where it is not.
        k.emplace_back(own.tip, share * own.slope);
        k.emplace_back(other.tip, share * other.slope);
        k.emplace_back(edge[0], -share * ((1 - own.foot) * own.slope + (1 - other.foot) * other.slope));
        k.emplace_back(edge[1], -share * (own.foot * own.slope + other.foot * other.slope));
      }
    }
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) visit(triangles[t], hinges[t]);
}

}  // namespace

std::vector<JoinedVertices> joined_by_cloth(const std::vector<FlatTriangle>& triangles, bool with_bending) {
  std::vector<JoinedVertices> pairs;
  for (const FlatTriangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) pairs.emplace_back(triangle.corner[k], triangle.corner[(k + 1) % 3]);
  }
  if (!with_bending) return pairs;
  for_each_hinged(triangles, [&](const FlatTriangle&, const std::array<Combination, 3>& hinges) {
    std::vector<std::int32_t> all;
    for (const Combination& hinge : hinges) {
      for (const auto& [vertex, factor] : hinge) all.push_back(vertex);
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) pairs.emplace_back(all[j], all[i]);
    }
  });
  return pairs;
}

// A triangle's normals at the middles of its edges, each between those of the two triangles there, give its shape
// operator S = sum_i |K_i x| t_i t_i^T / (2 A) with t_i the unit normal of edge i in the plane (Grinspun, Gingold,
// Reisman, Zorin 2006, "Computing discrete shape operators on general meshes", section 4). Its energy is A B/2 |S|^2,
// which without Gaussian curvature is that of a plate. (t_i . t_j)^2 is what |S|^2 has of the pair of edges i and j.
Eigen::SparseMatrix<double> bending_matrix(const Model& model, const std::vector<FlatTriangle>& triangles) {
  std::vector<Eigen::Triplet<double>> entries;
  for_each_hinged(triangles, [&](const FlatTriangle& triangle, const std::array<Combination, 3>& hinges) {
    const double weight = 1 / (4 * triangle.area());
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const Eigen::Vector2d a = corner_of(triangle, (i + 1) % 3) - corner_of(triangle, i);
        const Eigen::Vector2d b = corner_of(triangle, (j + 1) % 3) - corner_of(triangle, j);
        const double cosine = a.dot(b) / (a.norm() * b.norm());
        for (const auto& [v, of_v] : hinges[std::size_t(i)]) {
          for (const auto& [u, of_u] : hinges[std::size_t(j)])
            entries.emplace_back(model.internal_of[v], model.internal_of[u], weight * cosine * cosine * of_v * of_u);
        }
      }
    }
  });
  Eigen::SparseMatrix<double> matrix(model.vertices, model.vertices);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

double bending_energy(const Model& model, const Positions& x) {
  if (model.bending.begin.empty()) return 0;
  double sum = 0;
  for (int v = 0; v < model.vertices; ++v) {
    for (std::int32_t k = model.bending.begin[v]; k < model.bending.begin[v + 1]; ++k)
      sum -= 0.25 * model.bending.value[k] * (x.row(v) - x.row(model.bending.column[k])).squaredNorm();
  }
  return sum;
}

}  // namespace supple
