#include "sim/model/bending.h"

#include <algorithm>
#include <array>
#include <map>

namespace supple {
namespace {

// Describes a triangle as one of its edges sees it.
struct Flap {
  std::int32_t tip;
  double area;       // of the triangle [m^2]
  double height;     // of the tip over the edge [m]
  double length;     // of the edge [m]
  double foot;       // where the foot of the height is: 0 at the edge's first vertex, 1 at its second one
  double cotangent;  // of the angle at the tip
  // The areas of the triangle that belong to the edge's first and second vertex and to the tip [m^2].
  std::array<double, 3> share;
};

using Edge = std::array<std::int32_t, 2>;  // the first vertex is the lower one
using Flaps = std::map<Edge, std::vector<Flap>>;

Eigen::Vector2d corner_of(const FlatTriangle& triangle, int corner) {
  if (corner == 0) return {0, 0};
  return {triangle.edges[corner - 1], triangle.edges[2 + corner - 1]};
}

// Returns the part of a triangle that is nearest to a corner; of a triangle with an obtuse angle half at that angle and
// a quarter at the others (Meyer, Desbrun, Schroeder, Barr 2003, "Discrete differential-geometry operators for
// triangulated 2-manifolds", section 3.3) [m^2].
double area_of_corner(const FlatTriangle& triangle, int corner) {
  const auto angle_at = [&](int k) {  // its cosine times both sides
    const Eigen::Vector2d p = corner_of(triangle, k);
    return (corner_of(triangle, (k + 1) % 3) - p).dot(corner_of(triangle, (k + 2) % 3) - p);
  };
  const double area = triangle.area();
  if (angle_at(corner) < 0) return area / 2;
  const int next = (corner + 1) % 3, last = (corner + 2) % 3;
  if (angle_at(next) < 0 || angle_at(last) < 0) return area / 4;
  const auto side = [&](int a, int b) { return (corner_of(triangle, a) - corner_of(triangle, b)).squaredNorm(); };
  return (side(corner, next) * angle_at(last) + side(corner, last) * angle_at(next)) / (16 * area);
}

// edge: the edge from corner `edge` to the next one.
Flap flap_of(const FlatTriangle& triangle, int edge) {
  int from = edge, to = (edge + 1) % 3;
  const int tip = (edge + 2) % 3;
  if (triangle.corner[from] > triangle.corner[to]) std::swap(from, to);
  const Eigen::Vector2d along = corner_of(triangle, to) - corner_of(triangle, from);
  const Eigen::Vector2d rise = corner_of(triangle, tip) - corner_of(triangle, from);
  const double length = along.norm(), area = triangle.area();
  const double cotangent = rise.dot(rise - along) / (2 * area);
  return {triangle.corner[tip],
          area,
          2 * area / length,
          length,
          rise.dot(along) / (length * length),
          cotangent,
          {area_of_corner(triangle, from), area_of_corner(triangle, to), area_of_corner(triangle, tip)}};
}

Flaps flaps_of(const std::vector<FlatTriangle>& triangles) {
  Flaps flaps;
  for (const FlatTriangle& triangle : triangles) {
    for (int e = 0; e < 3; ++e) {
      Edge edge{triangle.corner[e], triangle.corner[(e + 1) % 3]};
      std::sort(edge.begin(), edge.end());
      flaps[edge].push_back(flap_of(triangle, e));
    }
  }
  return flaps;
}

// Holds one square of the energy, B/2 weight |sum_i factor_i x_i|^2.
struct Square {
  std::vector<std::pair<std::int32_t, double>> terms;  // vertex and factor
  double weight;
};

// Returns the angle of a hinge between two triangles: (tip - foot) / height + (other tip - other foot) / other height,
// two opposite unit vectors where it is flat, and 2 sin(angle/2) in length where it is not. Its energy is l^2 angle^2 /
// (area + other area), of which it has a share.
Square hinge_of(const Edge& edge, const Flap& own, const Flap& other, double share) {
  return {{{own.tip, 1 / own.height},
           {other.tip, 1 / other.height},
           {edge[0], -(1 - own.foot) / own.height - (1 - other.foot) / other.height},
           {edge[1], -own.foot / own.height - other.foot / other.height}},
          share * own.length * own.length / (own.area + other.area)};
}

class Squares {
 public:
  explicit Squares(const std::vector<FlatTriangle>& triangles) : flaps_(flaps_of(triangles)) {
    for (const FlatTriangle& triangle : triangles) {
      for (int k = 0; k < 3; ++k) area_[triangle.corner[k]] += area_of_corner(triangle, k);
    }
    for (const auto& [edge, flaps] : flaps_) {
      if (flaps.size() == 2) continue;
      for (const std::int32_t v : edge) area_[v] = 0;
    }
  }

  // Calls visit(Square) for all of them.
  template <class Visit>
  void for_each(const Visit& visit) const {
    std::map<std::int32_t, Square> laplacians;
    for (const auto& [edge, flaps] : flaps_) {
      for (int end = 0; end < 2; ++end) add_to_laplacian(edge[end], edge[1 - end], flaps, laplacians);
      for (std::size_t i = 0; i < flaps.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
          const double share = border_share(edge, flaps[i], flaps[j]) / double(flaps.size() - 1);
          if (share > 0) visit(hinge_of(edge, flaps[i], flaps[j], share));
        }
      }
    }
    for (const auto& [vertex, square] : laplacians) visit(square);
  }

 private:
  // An area of 0 tells that a vertex is on a border, or where more than two triangles share an edge.
  bool is_inside(std::int32_t v) const { return area_.at(v) > 0; }

  void add_to_laplacian(std::int32_t vertex, std::int32_t neighbour, const std::vector<Flap>& flaps,
                        std::map<std::int32_t, Square>& laplacians) const {
    if (!is_inside(vertex)) return;
    double weight = 0;
    for (const Flap& flap : flaps) weight += 0.5 * flap.cotangent;
    Square& square = laplacians[vertex];
    square.weight = 1 / area_.at(vertex);
    if (square.terms.empty()) square.terms.emplace_back(vertex, 0.0);
    square.terms.front().second -= weight;
    square.terms.emplace_back(neighbour, weight);
  }

  // Returns the share of the area of two triangles that belongs to corners on a border.
  double border_share(const Edge& edge, const Flap& own, const Flap& other) const {
    double area = 0;
    for (const Flap& flap : {own, other}) {
      if (!is_inside(edge[0])) area += flap.share[0];
      if (!is_inside(edge[1])) area += flap.share[1];
      if (!is_inside(flap.tip)) area += flap.share[2];
    }
    return area / (own.area + other.area);
  }

  Flaps flaps_;
  std::map<std::int32_t, double> area_;  // by vertex [m^2]
};

}  // namespace

std::vector<JoinedVertices> joined_by_cloth(const std::vector<FlatTriangle>& triangles, bool with_bending) {
  std::vector<JoinedVertices> pairs;
  for (const FlatTriangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) pairs.emplace_back(triangle.corner[k], triangle.corner[(k + 1) % 3]);
  }
  if (!with_bending) return pairs;
  Squares(triangles).for_each([&](const Square& square) {
    for (std::size_t i = 0; i < square.terms.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) pairs.emplace_back(square.terms[j].first, square.terms[i].first);
    }
  });
  return pairs;
}

Eigen::SparseMatrix<double> bending_matrix(const Model& model, const std::vector<FlatTriangle>& triangles) {
  std::vector<Eigen::Triplet<double>> entries;
  Squares(triangles).for_each([&](const Square& square) {
    for (const auto& [v, of_v] : square.terms) {
      for (const auto& [u, of_u] : square.terms)
        entries.emplace_back(model.internal_of[v], model.internal_of[u], square.weight * of_v * of_u);
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
