#include "sim/model/bending.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <Eigen/Dense>

namespace supple {
namespace {

// Describes a triangle as one of its edges sees it.
struct Flap {
  std::int32_t triangle;
  int edge;  // the edge from corner `edge` to the next one
  std::int32_t tip;
  double height;  // of the tip over the edge [m]
  double length;  // of the edge [m]
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
  const double length = along.norm();
  return {
      number, edge, triangle.corner[tip], 2 * triangle.area() / length, length, rise.dot(along) / (length * length)};
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

// Holds a hinge of a triangle: a linear function K of the positions that is zero on flat sheets, and what K is for each
// of the quadratic functions 1/2 p . h p, h = (1 0; 0 0), (0 1; 1 0)/sqrt(2), (0 0; 0 1), over the triangle's own
// plane.
struct Hinge {
  std::array<std::int32_t, 4> vertex;  // the two of the edge, the triangle's tip, the other triangle's tip
  std::array<double, 4> factor;
  Eigen::RowVector3d of_curvature;
};

Eigen::RowVector3d quadratics(const Eigen::Vector2d& p) {
  return {0.5 * p.x() * p.x(), p.x() * p.y() / std::sqrt(2.0), 0.5 * p.y() * p.y()};
}

// K x is (tip - foot) / height + (other tip - other foot) / other height: two opposite unit vectors where the hinge is
// flat, and 2 sin(angle/2) in length where it is not. The other triangle is laid flat beside the own one.
Hinge hinge_of(const FlatTriangle& triangle, const Edge& edge, const Flap& own, const Flap& other) {
  Hinge hinge{{edge[0], edge[1], own.tip, other.tip}, {}, {}};
  hinge.factor = {-(1 - own.foot) / own.height - (1 - other.foot) / other.height,
                  -own.foot / own.height - other.foot / other.height, 1 / own.height, 1 / other.height};
  int from = own.edge, to = (own.edge + 1) % 3;
  if (triangle.corner[from] != edge[0]) std::swap(from, to);
  const Eigen::Vector2d first = corner_of(triangle, from), second = corner_of(triangle, to);
  const Eigen::Vector2d tip = corner_of(triangle, (own.edge + 2) % 3);
  const Eigen::Vector2d away = (first + own.foot * (second - first) - tip) / own.height;
  const Eigen::Vector2d beyond = first + other.foot * (second - first) + other.height * away;
  const std::array<Eigen::Vector2d, 4> flat = {first, second, tip, beyond};
  hinge.of_curvature.setZero();
  for (std::size_t i = 0; i < 4; ++i) hinge.of_curvature += hinge.factor[i] * quadratics(flat[i]);
  return hinge;
}

// Calls visit(triangle, hinges) for each triangle. A border has no hinge. Where more than two triangles meet at an
// edge, each has a hinge with each of the others.
template <class Visit>
void for_each_hinged(const std::vector<FlatTriangle>& triangles, const Visit& visit) {
  std::vector<std::vector<Hinge>> hinges(triangles.size());
  for (const auto& [edge, flaps] : flaps_by_edge(triangles)) {
    for (const Flap& own : flaps) {
      for (const Flap& other : flaps) {
        if (&other != &own)
          hinges[std::size_t(own.triangle)].push_back(hinge_of(triangles[std::size_t(own.triangle)], edge, own, other));
      }
    }
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) visit(triangles[t], hinges[t]);
}

// Returns the matrix that takes the hinges of a triangle to the curvature (xx, sqrt(2) xy, yy) of the sheet there. A
// sheet whose height is any quadratic function has its own curvature so, whatever the mesh. At the border, hinges do
// not tell the whole curvature: the least one is taken, as a free border is not bent. So it is where the six vertices
// lie almost on a conic, and a bend in one direction hardly moves any hinge.
Eigen::MatrixXd curvature_of(const std::vector<Hinge>& hinges) {
  constexpr double least = 0.1;  // singular value, where each hinge has a row of length 1
  Eigen::MatrixXd rows(hinges.size(), 3);
  Eigen::VectorXd length(hinges.size());
  for (std::size_t i = 0; i < hinges.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    length[row] = hinges[i].of_curvature.norm();
    rows.row(row) = hinges[i].of_curvature / length[row];
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeThinU | Eigen::ComputeThinV);
  Eigen::VectorXd inverse = svd.singularValues();
  for (double& s : inverse) s = s > least ? 1 / s : 0;
  return svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose() * length.cwiseInverse().asDiagonal();
}

}  // namespace

std::vector<JoinedVertices> joined_by_cloth(const std::vector<FlatTriangle>& triangles, bool with_bending) {
  std::vector<JoinedVertices> pairs;
  for (const FlatTriangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) pairs.emplace_back(triangle.corner[k], triangle.corner[(k + 1) % 3]);
  }
  if (!with_bending) return pairs;
  for_each_hinged(triangles, [&](const FlatTriangle&, const std::vector<Hinge>& hinges) {
    std::vector<std::int32_t> all;
    for (const Hinge& hinge : hinges) all.insert(all.end(), hinge.vertex.begin(), hinge.vertex.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) pairs.emplace_back(all[j], all[i]);
    }
  });
  return pairs;
}

// The energy of a triangle is A B/2 |S|^2 with S the curvature that fits its hinges, that of the quadratic function
// through its corners and the tips of its neighbours (Zorin 2005, "Curvature-based energy for simulation and
// variational modeling"). Without Gaussian curvature this is the energy of a plate.
Eigen::SparseMatrix<double> bending_matrix(const Model& model, const std::vector<FlatTriangle>& triangles) {
  std::vector<Eigen::Triplet<double>> entries;
  for_each_hinged(triangles, [&](const FlatTriangle& triangle, const std::vector<Hinge>& hinges) {
    if (hinges.empty()) return;
    const Eigen::MatrixXd curvature = curvature_of(hinges);
    const Eigen::MatrixXd energy = triangle.area() * curvature.transpose() * curvature;  // by pairs of hinges
    for (std::size_t i = 0; i < hinges.size(); ++i) {
      for (std::size_t j = 0; j < hinges.size(); ++j) {
        const double weight = energy(Eigen::Index(i), Eigen::Index(j));
        for (std::size_t u = 0; u < 4; ++u) {
          for (std::size_t v = 0; v < 4; ++v)
            entries.emplace_back(model.internal_of[hinges[i].vertex[u]], model.internal_of[hinges[j].vertex[v]],
                                 weight * hinges[i].factor[u] * hinges[j].factor[v]);
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
