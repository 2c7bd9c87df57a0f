#include "sim/model/bending.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "sim/elements/triangle.h"

namespace supple {
namespace {

// Describes a triangle relative to one of its edges.
struct Flap {
  int triangle;  // its number
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

// Returns the area of the part of a triangle that is nearest to a corner; in a triangle with an obtuse angle, half of
// its area at that angle and a quarter at the others (Meyer, Desbrun, Schroeder, Barr 2003, "Discrete
// differential-geometry operators for triangulated 2-manifolds", section 3.3) [m^2].
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

// Describes a triangle relative to its edge from corner `edge` to the next one. number: the triangle's.
Flap flap_of(const std::vector<FlatTriangle>& triangles, int number, int edge) {
  const FlatTriangle& triangle = triangles[std::size_t(number)];
  int from = edge, to = (edge + 1) % 3;
  const int tip = (edge + 2) % 3;
  if (triangle.corner[from] > triangle.corner[to]) std::swap(from, to);
  const Eigen::Vector2d along = corner_of(triangle, to) - corner_of(triangle, from);
  const Eigen::Vector2d rise = corner_of(triangle, tip) - corner_of(triangle, from);
  const double length = along.norm(), area = triangle.area();
  const double cotangent = rise.dot(rise - along) / (2 * area);
  return {number,    triangle.corner[tip],
          area,      2 * area / length,
          length,    rise.dot(along) / (length * length),
          cotangent, {area_of_corner(triangle, from), area_of_corner(triangle, to), area_of_corner(triangle, tip)}};
}

// Returns the edge from corner `number` to the next one.
Edge edge_of(const FlatTriangle& triangle, int number) {
  Edge edge{triangle.corner[number], triangle.corner[(number + 1) % 3]};
  std::sort(edge.begin(), edge.end());
  return edge;
}

Flaps flaps_of(const std::vector<FlatTriangle>& triangles) {
  Flaps flaps;
  for (int t = 0; t < std::ssize(triangles); ++t) {
    for (int e = 0; e < 3; ++e) flaps[edge_of(triangles[std::size_t(t)], e)].push_back(flap_of(triangles, t, e));
  }
  return flaps;
}

// Holds one square of the energy, B/2 weight |sum_i factor_i x_i|^2.
struct Square {
  std::vector<std::pair<std::int32_t, double>> terms;  // vertex and factor
  double weight = 0;
  std::vector<std::pair<int, double>> turned_by = {};  // triangles and their shares, for cloth that is curved at rest
};

// Returns the square for a hinge between two triangles. Its sum is (tip - foot) / height + (other tip - other foot) /
// other height: two unit vectors, which are opposite where the hinge is flat, so that the sum has the length 2
// sin(angle/2). The energy of a hinge is B/2 l^2 angle^2 / (area + other area), of which the square has a share.
Square hinge_of(const Edge& edge, const Flap& own, const Flap& other, double share) {
  return {{{own.tip, 1 / own.height},
           {other.tip, 1 / other.height},
           {edge[0], -(1 - own.foot) / own.height - (1 - other.foot) / other.height},
           {edge[1], -own.foot / own.height - other.foot / other.height}},
          share * own.length * own.length / (own.area + other.area),
          {{own.triangle, 0.5}, {other.triangle, 0.5}}};
}

// Finds the squares of flat cloth: one at each vertex inside, and one at each hinge near the border.
class Squares {
 public:
  explicit Squares(const std::vector<FlatTriangle>& triangles) : flaps_(flaps_of(triangles)) {
    for (int t = 0; t < std::ssize(triangles); ++t) {
      const FlatTriangle& triangle = triangles[std::size_t(t)];
      for (int k = 0; k < 3; ++k) {
        area_[triangle.corner[k]] += area_of_corner(triangle, k);
        shares_[triangle.corner[k]].emplace_back(t, area_of_corner(triangle, k));
      }
    }
    for (const auto& [edge, flaps] : flaps_) {
      if (flaps.size() == 2) continue;
      for (const std::int32_t v : edge) area_[v] = 0;
    }
  }

  // Calls visit(square) for all squares of the energy.
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
    for (auto& [vertex, square] : laplacians) {
      square.turned_by = shares_.at(vertex);
      for (auto& [triangle, share] : square.turned_by) share /= area_.at(vertex);
      visit(square);
    }
  }

 private:
  // Tells whether a vertex has an area. It has none on a border, and where more than two triangles share an edge.
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
  std::map<std::int32_t, double> area_;                                 // by vertex [m^2]
  std::map<std::int32_t, std::vector<std::pair<int, double>>> shares_;  // by vertex: triangles and their shares of it
};

// Holds the vertices of a triangle and the tips of its neighbours, which are laid flat beside it.
struct Patch {
  std::array<std::int32_t, 6> vertex;
  std::array<Eigen::Vector2d, 6> place;
};

// Returns the patch of a triangle; nothing where one of its edges has no other triangle, or several.
std::optional<Patch> patch_of(const FlatTriangle& triangle, int number, const Flaps& flaps) {
  Patch patch;
  for (int e = 0; e < 3; ++e) {
    patch.vertex[std::size_t(e)] = triangle.corner[e];
    patch.place[std::size_t(e)] = corner_of(triangle, e);
    const Edge edge = edge_of(triangle, e);
    const std::vector<Flap>& around = flaps.at(edge);
    if (around.size() != 2) return std::nullopt;
    const Flap& other = around[around[0].triangle == number ? 1 : 0];
    const bool is_first = triangle.corner[e] == edge[0];
    const Eigen::Vector2d from = corner_of(triangle, is_first ? e : (e + 1) % 3);
    const Eigen::Vector2d along = corner_of(triangle, is_first ? (e + 1) % 3 : e) - from;
    Eigen::Vector2d out(along.y(), -along.x());
    if (out.dot(corner_of(triangle, (e + 2) % 3) - from) > 0) out = -out;
    patch.vertex[3 + std::size_t(e)] = other.tip;
    patch.place[3 + std::size_t(e)] = from + other.foot * along + other.height * out.normalized();
  }
  return patch;
}

using SecondDerivatives = Eigen::Matrix<double, 3, 6>;  // xx, xy and yy of a function by its values in a patch [1/m^2]

// Differentiates the quadratic function that has given values in a patch. Returns nothing where the places are close to
// a conic: such a function is nearly undetermined, and its derivatives would follow noise.
std::optional<SecondDerivatives> second_derivatives(const Patch& patch, double area) {
  constexpr double largest = 20;  // of the sum of factors times the area; right triangles of a grid have 2
  const double size = std::sqrt(area);
  Eigen::Matrix<double, 6, 6> values;  // of the six monomials
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector2d p = (patch.place[std::size_t(i)] - patch.place[0]) / size;
    values.row(i) << 1, p.x(), p.y(), 0.5 * p.x() * p.x(), p.x() * p.y(), 0.5 * p.y() * p.y();
  }
  const Eigen::FullPivLU<Eigen::Matrix<double, 6, 6>> factor(values);
  if (!factor.isInvertible()) return std::nullopt;
  const SecondDerivatives found = factor.inverse().bottomRows<3>();
  if (!(found.cwiseAbs().rowwise().sum().maxCoeff() < largest)) return std::nullopt;
  return SecondDerivatives(found / area);
}

// Finds the squares of cloth that is curved at rest: those of flat cloth with half of their weight, and the deviator of
// each triangle that has three neighbours. The area of the other triangles counts at their hinges.
class CurvedSquares {
 public:
  explicit CurvedSquares(const std::vector<FlatTriangle>& triangles)
      : triangles_(triangles), flaps_(flaps_of(triangles)), mean_(triangles), deviators_(triangles.size()) {
    for (int t = 0; t < std::ssize(triangles); ++t) {
      const auto patch = patch_of(triangles[std::size_t(t)], t, flaps_);
      if (!patch) continue;
      const auto second = second_derivatives(*patch, triangles[std::size_t(t)].area());
      if (second) deviators_[std::size_t(t)] = {*patch, *second};
    }
  }

  template <class Visit>
  void for_each(const Visit& visit) const {
    mean_.for_each([&](Square square) {
      square.weight *= 0.5;
      visit(square);
    });
    for (int t = 0; t < std::ssize(triangles_); ++t) {
      if (deviators_[std::size_t(t)]) visit_deviator(t, visit);
    }
    for (const auto& [edge, flaps] : flaps_) {
      for (std::size_t i = 0; i < flaps.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
          const double share = 0.5 * bare_share(flaps[i], flaps[j]) / double(flaps.size() - 1);
          if (share > 0) visit(hinge_of(edge, flaps[i], flaps[j], share));
        }
      }
    }
  }

 private:
  struct Deviator {
    Patch patch;
    SecondDerivatives second;
  };

  // Visits both squares of a deviator: the squared norm of the deviator of S is (S_xx - S_yy)^2 / 2 + 2 S_xy^2.
  template <class Visit>
  void visit_deviator(int t, const Visit& visit) const {
    const auto& [patch, second] = *deviators_[std::size_t(t)];
    const double area = triangles_[std::size_t(t)].area();
    Square apart{{}, 0.5 * area, {{t, 1.0}}}, mixed{{}, 2 * area, {{t, 1.0}}};
    for (int i = 0; i < 6; ++i) {
      apart.terms.emplace_back(patch.vertex[std::size_t(i)], second(0, i) - second(2, i));
      mixed.terms.emplace_back(patch.vertex[std::size_t(i)], second(1, i));
    }
    visit(apart);
    visit(mixed);
  }

  // Returns the share of the area of two triangles that belongs to triangles without a deviator.
  double bare_share(const Flap& own, const Flap& other) const {
    double area = 0;
    for (const Flap* flap : {&own, &other}) area += deviators_[std::size_t(flap->triangle)] ? 0 : flap->area;
    return area / (own.area + other.area);
  }

  const std::vector<FlatTriangle>& triangles_;
  Flaps flaps_;
  Squares mean_;
  std::vector<std::optional<Deviator>> deviators_;  // by triangle
};

template <class Visit>
void for_each_square(const BodyDescription& body, const Visit& visit) {
  if (body.curved) {
    CurvedSquares(body.cloth).for_each(visit);
  } else {
    Squares(body.cloth).for_each(visit);
  }
}

Vec3 sum_of(const Square& square, const Positions& x) {
  Vec3 sum = Vec3::Zero();
  const std::int32_t first = square.terms.front().first;
  for (const auto& [v, factor] : square.terms) sum += factor * (x.row(v) - x.row(first)).transpose();
  return sum;
}

}  // namespace

void BendingRoom::take(const double* x, int vertices) {
  places.resize(4 * std::size_t(vertices));
  forces.resize(places.size());
  squares.resize(std::size_t(vertices));
  for (std::size_t v = 0; v < squares.size(); ++v) {
    for (std::size_t c = 0; c < 3; ++c) places[4 * v + c] = x[3 * v + c];
  }
}

std::vector<JoinedVertices> joined_by_cloth(const BodyDescription& body) {
  std::vector<JoinedVertices> pairs;
  for (const FlatTriangle& triangle : body.cloth) {
    for (int k = 0; k < 3; ++k) pairs.emplace_back(triangle.corner[k], triangle.corner[(k + 1) % 3]);
  }
  if (body.fabric.bending <= 0) return pairs;
  for_each_square(body, [&](const Square& square) {
    for (std::size_t i = 0; i < square.terms.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) pairs.emplace_back(square.terms[j].first, square.terms[i].first);
    }
  });
  return pairs;
}

Eigen::SparseMatrix<double> bending_matrix(const Model& model, const BodyDescription& body) {
  std::vector<Eigen::Triplet<double>> entries;
  for_each_square(body, [&](const Square& square) {
    for (const auto& [v, of_v] : square.terms) {
      for (const auto& [u, of_u] : square.terms)
        entries.emplace_back(model.internal_of[v], model.internal_of[u], square.weight * of_v * of_u);
    }
  });
  Eigen::SparseMatrix<double> matrix(model.vertices, model.vertices);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

RestCurvature rest_curvature(const Model& model, const BodyDescription& body) {
  RestCurvature curvature;
  for (const FlatTriangle& triangle : body.cloth) {
    RestCurvature::Triangle& added = curvature.triangles.emplace_back();
    for (int k = 0; k < 3; ++k) added.corner[std::size_t(k)] = model.internal_of[triangle.corner[std::size_t(k)]];
    added.edge = added.twice_area = 1;
    const TriangleAxes sides(added, model.rest.data());
    added.edge = sides.edge.norm();
    added.twice_area = sides.cross.norm();
  }
  std::vector<std::vector<RestCurvature::Turn>> turns(body.cloth.size());
  curvature.first_term.push_back(0);
  for_each_square(body, [&](const Square& square) {
    const double root = std::sqrt(square.weight);
    const Vec3 at_rest = root * sum_of(square, body.mesh.rest);
    for (const auto& [t, share] : square.turned_by) {
      const TriangleAxes axes(curvature.triangles[std::size_t(t)], model.rest.data());
      turns[std::size_t(t)].push_back(
          {curvature.squares(), share, {axes.along.dot(at_rest), axes.across.dot(at_rest), axes.normal.dot(at_rest)}});
    }
    for (const auto& [v, factor] : square.terms) curvature.terms.push_back({model.internal_of[v], root * factor});
    curvature.first_term.push_back(static_cast<std::int32_t>(curvature.terms.size()));
  });
  for (std::size_t t = 0; t < turns.size(); ++t) {
    curvature.triangles[t].first_turn = static_cast<std::int32_t>(curvature.turns.size());
    curvature.triangles[t].turns = static_cast<std::int32_t>(turns[t].size());
    curvature.turns.insert(curvature.turns.end(), turns[t].begin(), turns[t].end());
  }
  return curvature;
}

double bending_energy(const Model& model, const Positions& x) {
  if (model.bending.begin.empty()) return 0;
  double sum = 0;
  for (int v = 0; v < model.vertices; ++v) {
    if (model.curvature.holds(v)) continue;
    for (std::int32_t k = model.bending.begin[v]; k < model.bending.begin[v + 1]; ++k)
      sum -= 0.25 * model.bending.value[k] * (x.row(v) - x.row(model.bending.column[k])).squaredNorm();
  }
  if (model.curvature.empty()) return sum;
  CurvatureRoom room;
  std::vector<double> energy;
  evaluate_curvature(model.curvature, nullptr, x.data(), room, energy);
  for (const double of_triangle : energy) sum += of_triangle;
  return sum;
}

}  // namespace supple
