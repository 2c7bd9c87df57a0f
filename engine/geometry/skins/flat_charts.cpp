#include "geometry/skins/flat_charts.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <queue>
#include <utility>

#include "base/disjoint_sets.h"
#include "geometry/triangles/triangle_edges.h"

namespace supple {
namespace {

// Holds what is known of the triangles.
struct Surface {
  const Positions& points;
  const Triangles& triangles;
  Positions normals;                                // of unit length; zero without area
  std::vector<double> area;                         // [m^2]
  std::vector<std::array<std::int32_t, 3>> beside;  // by the edge from corner k on: the other triangle there, or -1

  Surface(const Positions& at, const Triangles& of)
      : points(at), triangles(of), normals(of.rows(), 3), beside(std::size_t(of.rows()), {-1, -1, -1}) {
    for (std::int32_t t = 0; t < of.rows(); ++t) {
      const Vec3 normal = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
      const double twice = normal.norm();
      normals.row(t) = (twice > 0 ? Vec3(normal / twice) : Vec3(Vec3::Zero())).transpose();
      area.push_back(0.5 * twice);
    }
    // Where more than two triangles share an edge, the first two of them count as neighbours.
    const std::vector<TriangleEdge> edges = sorted_edges(of);
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const TriangleEdge &one = edges[i], &other = edges[i + 1];
      const auto is_same = [&one](const TriangleEdge& edge) { return edge.low == one.low && edge.high == one.high; };
      if (!is_same(other)) continue;
      beside[std::size_t(one.triangle)][std::size_t(one.side)] = other.triangle;
      beside[std::size_t(other.triangle)][std::size_t(other.side)] = one.triangle;
      while (i + 1 < edges.size() && is_same(edges[i + 1])) ++i;
    }
  }

  std::int32_t count() const { return std::int32_t(triangles.rows()); }
  Vec3 corner(std::int32_t t, int k) const { return points.row(triangles(t, k)); }
  Vec3 normal(std::int32_t t) const { return normals.row(t); }
  Vec3 middle(std::int32_t t) const { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3; }
};

// Returns the axis that the surface faces least; y where several are alike.
int axis_of(const Surface& surface) {
  constexpr std::array<double, 3> liking = {1.1, 1, 1.2};
  Vec3 facing = Vec3::Zero();
  for (std::int32_t t = 0; t < surface.count(); ++t)
    facing += surface.area[std::size_t(t)] * surface.normal(t).cwiseAbs2();
  int axis = 1;
  for (const int k : {0, 2})
    if (liking[std::size_t(k)] * facing[k] < liking[std::size_t(axis)] * facing[axis]) axis = k;
  return axis;
}

// Tells of each triangle whether it is in a wall. Single triangles go with those around them.
std::vector<char> find_walls(const Surface& surface, int axis) {
  constexpr double steepest = 0.8;  // cosine
  constexpr int rounds = 4;
  std::vector<char> wall;
  for (std::int32_t t = 0; t < surface.count(); ++t) wall.push_back(std::abs(surface.normals(t, axis)) < steepest);
  for (int round = 0; round < rounds; ++round) {
    const std::vector<char> before = wall;
    for (std::int32_t t = 0; t < surface.count(); ++t) {
      int others = 0, count = 0;
      for (const std::int32_t other : surface.beside[std::size_t(t)]) {
        if (other < 0) continue;
        ++count;
        others += before[std::size_t(other)] != before[std::size_t(t)] ? 1 : 0;
      }
      if (2 * others > count) wall[std::size_t(t)] ^= 1;
    }
  }
  return wall;
}

// Tells of each triangle to which wall it belongs, -1 for none, and the how many-th of its triangles it is.
struct WallNumbers {
  std::vector<std::int32_t> wall, place;
};

// Lays a wall flat.
class Wall {
 public:
  // own: its triangles, which `numbers` has as those of the wall `name`.
  Wall(const Surface& surface, int axis, std::vector<std::int32_t> own, const WallNumbers& numbers, std::int32_t name)
      : surface_(surface), axis_(axis), own_(std::move(own)), numbers_(numbers), name_(name) {}

  // Returns false, and lays nothing, where the wall is too large, or its triangles are too thin for the sum of squares.
  bool lay(const Vec3& origin, std::vector<LaidTriangle>& result) {
    constexpr std::size_t most_nodes = 500'000;
    const std::int32_t seed = front();
    join_corners(seed);
    if (nodes_ > most_nodes) return false;
    Factor factor;
    const std::optional<Eigen::VectorXd> found_across = solve(true, factor), found_along = solve(false, factor);
    if (!found_across || !found_along) return false;
    const Eigen::VectorXd &across = *found_across, &along = *found_along;
    const PrintAxes axes = print_axes(surface_.normal(seed));
    const Vec3 there = surface_.corner(seed, 0) - origin;
    const std::size_t at = node(seed, 0);
    const double sign = direction(seed, true)[axes.across == axis_ ? axes.along : axes.across] < 0 ? -1 : 1;
    const bool is_turned = axes.across == axis_;
    for (const std::int32_t t : own_) {
      for (int k = 0; k < 3; ++k) {
        const auto n = Eigen::Index(node(t, k));
        const double u = sign * (across[n] - across[Eigen::Index(at)]), v = along[n] - along[Eigen::Index(at)];
        result[std::size_t(t)][std::size_t(k)] = Eigen::Vector2d(there[axes.across], there[axes.along]) +
                                                 (is_turned ? Eigen::Vector2d(v, u) : Eigen::Vector2d(u, v));
      }
    }
    return true;
  }

 private:
  using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

  // Returns the triangle in the middle of the front: of what is in front of the axis, or else beside it.
  std::int32_t front() const {
    constexpr double of_middle = 0.5;
    const int forward = axis_ == 2 ? 1 : 2;
    Bounds all;
    for (const std::int32_t t : own_) all.include(surface_.middle(t));
    std::int32_t best = own_.front();
    double most = -infinity;
    for (const std::int32_t t : own_) {
      Vec3 off = surface_.middle(t) - all.center();
      off[forward] = 0;
      const double score = surface_.normals(t, forward) - of_middle * off.norm() / std::max(all.diagonal(), 1e-300);
      if (score > most) {
        most = score;
        best = t;
      }
    }
    return best;
  }

  // Returns the direction around the axis in a triangle, or along it; zero where there is none.
  Vec3 direction(std::int32_t t, bool around) const {
    const Vec3 normal = surface_.normal(t);
    Vec3 along = Vec3::Unit(axis_) - normal[axis_] * normal;
    const double length = along.norm();
    if (!(length > 1e-6) || normal.isZero(0)) return Vec3::Zero();
    along /= length;
    return around ? Vec3(along.cross(normal)) : along;
  }

  std::size_t node(std::int32_t t, int k) const { return node_[3 * at(t) + std::size_t(k)]; }

  // Joins the corners of triangles at all edges but those of the seams. Each triangle is reached from the front on the
  // shortest way from middle to middle (Dijkstra 1959). What lies between these ways is a seam, as far as it goes from
  // border to border; its loose ends are sewn up.
  void join_corners(std::int32_t seed) {
    const std::size_t count = own_.size();
    std::vector<double> far(count, infinity);
    std::vector<std::array<char, 3>> sewn(count, {0, 0, 0});  // by triangle and edge
    using Waiting =
        std::pair<double, std::pair<std::int32_t, std::int32_t>>;  // with the triangle and where it comes from
    std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting;
    std::vector<char> is_reached(count, 0);
    waiting.push({0, {seed, -1}});
    while (!waiting.empty()) {
      const auto [way, step] = waiting.top();
      waiting.pop();
      const auto [t, from] = step;
      if (is_reached[at(t)] != 0) continue;
      is_reached[at(t)] = 1;
      if (from >= 0) sew(t, from, sewn);
      for (const std::int32_t other : surface_.beside[std::size_t(t)]) {
        if (!is_own(other) || is_reached[at(other)] != 0) continue;
        const double there = way + (surface_.middle(other) - surface_.middle(t)).norm();
        if (there >= far[at(other)]) continue;
        far[at(other)] = there;
        waiting.push({there, {other, t}});
      }
    }
    sew_loose_ends(sewn);
    DisjointSets corners(3 * count);
    for (const std::int32_t t : own_) {
      for (int k = 0; k < 3; ++k) {
        if (sewn[at(t)][std::size_t(k)] == 0) continue;
        const std::int32_t other = surface_.beside[std::size_t(t)][std::size_t(k)];
        for (const int end : {k, (k + 1) % 3})
          corners.join(3 * at(t) + std::size_t(end),
                       3 * at(other) + std::size_t(place_in(other, surface_.triangles(t, end))));
      }
    }
    std::map<std::size_t, std::size_t> names;
    for (std::size_t c = 0; c < 3 * count; ++c)
      node_.push_back(names.try_emplace(corners.of(c), names.size()).first->second);
    nodes_ = names.size();
  }

  void sew_loose_ends(std::vector<std::array<char, 3>>& sewn) const {
    std::map<std::int32_t, std::vector<std::pair<std::int32_t, int>>> open;  // seams by vertex: triangle and edge
    std::map<std::int32_t, int> is_border;
    for (const std::int32_t t : own_) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t other = surface_.beside[std::size_t(t)][std::size_t(k)];
        for (const int end : {k, (k + 1) % 3}) {
          const std::int32_t v = surface_.triangles(t, end);
          if (!is_own(other)) is_border[v] = 1;
          if (is_own(other) && t < other && sewn[at(t)][std::size_t(k)] == 0) open[v].push_back({t, k});
        }
      }
    }
    std::vector<std::int32_t> loose;
    for (const auto& [v, edges] : open)
      if (edges.size() == 1 && !is_border.contains(v)) loose.push_back(v);
    while (!loose.empty()) {
      const std::int32_t v = loose.back();
      loose.pop_back();
      auto& edges = open[v];
      if (edges.size() != 1) continue;
      const auto [t, k] = edges.front();
      sew(t, surface_.beside[std::size_t(t)][std::size_t(k)], sewn);
      const std::int32_t a = surface_.triangles(t, k), b = surface_.triangles(t, (k + 1) % 3), far_end = a == v ? b : a;
      edges.clear();
      std::erase(open[far_end], std::pair(t, k));
      if (open[far_end].size() == 1 && !is_border.contains(far_end)) loose.push_back(far_end);
    }
  }

  // Finds the numbers at the nodes whose slope is nearest to one in the asked direction and to nothing across it. The
  // pattern of the matrix is the same for both directions. Returns nothing where rounding leaves no solution.
  std::optional<Eigen::VectorXd> solve(bool around, Factor& factor) const {
    constexpr double across_weight = 4, least = 1e-9;
    constexpr double thinnest = 1e-7;  // twice the area over the square of the longest edge
    std::vector<Eigen::Triplet<double>> entries;
    const auto size = static_cast<Eigen::Index>(nodes_);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (const std::int32_t t : own_) {
      const double area = surface_.area[std::size_t(t)];
      const Vec3 wanted = direction(t, around), other = direction(t, !around), normal = surface_.normal(t);
      double longest = 0;
      for (int k = 0; k < 3; ++k)
        longest = std::max(longest, (surface_.corner(t, (k + 1) % 3) - surface_.corner(t, k)).squaredNorm());
      const bool counts = 2 * area > thinnest * longest && !wanted.isZero(0);
      std::array<Vec3, 3> slope;  // of the function that is 1 at a corner and 0 at the others [1/m]
      for (int k = 0; k < 3; ++k) {
        const Vec3 opposite = surface_.corner(t, (k + 2) % 3) - surface_.corner(t, (k + 1) % 3);
        slope[std::size_t(k)] = counts ? Vec3(normal.cross(opposite) / (2 * area)) : Vec3(Vec3::Zero());
      }
      for (std::size_t a = 0; a < 3; ++a) {
        const auto row = static_cast<int>(node(t, int(a)));
        right[row] += area * wanted.dot(slope[a]);
        for (std::size_t b = 0; b < 3; ++b) {
          const double value = area * (wanted.dot(slope[a]) * wanted.dot(slope[b]) +
                                       across_weight * other.dot(slope[a]) * other.dot(slope[b]));
          entries.emplace_back(row, int(node(t, int(b))), value + (a == b ? least : 0));
        }
      }
    }
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (factor.rows() == 0) factor.analyzePattern(matrix);
    factor.factorize(matrix);
    if (factor.info() != Eigen::Success) return std::nullopt;
    Eigen::VectorXd result = factor.solve(right);
    if (!result.allFinite()) return std::nullopt;
    return result;
  }

  std::size_t at(std::int32_t t) const { return std::size_t(numbers_.place[std::size_t(t)]); }
  bool is_own(std::int32_t t) const { return t >= 0 && numbers_.wall[std::size_t(t)] == name_; }
  int place_in(std::int32_t t, std::int32_t vertex) const {
    return surface_.triangles(t, 0) == vertex ? 0 : surface_.triangles(t, 1) == vertex ? 1 : 2;
  }
  void sew(std::int32_t one, std::int32_t other, std::vector<std::array<char, 3>>& sewn) const {
    for (const auto& [t, beside] : {std::pair(one, other), std::pair(other, one)}) {
      for (std::size_t k = 0; k < 3; ++k)
        if (surface_.beside[std::size_t(t)][k] == beside) sewn[at(t)][k] = 1;
    }
  }

  const Surface& surface_;
  int axis_;
  std::vector<std::int32_t> own_;  // triangles
  const WallNumbers& numbers_;
  std::int32_t name_;
  std::vector<std::size_t> node_;  // by corner of own triangles: what is joined has one number
  std::size_t nodes_ = 0;
};

}  // namespace

PrintAxes print_axes(const Vec3& normal) {
  int faced = 0;
  normal.cwiseAbs().maxCoeff(&faced);
  return {faced == 0 ? 2 : 0, faced == 1 ? 2 : 1};
}

std::vector<LaidTriangle> laid_triangles(const Positions& points, const Triangles& triangles) {
  const Surface surface(points, triangles);
  const Vec3 origin = bounds_of(points).lower;
  const int axis = axis_of(surface);
  const std::vector<char> in_wall = find_walls(surface, axis);
  const PrintAxes of_caps = print_axes(Vec3::Unit(axis));
  std::vector<LaidTriangle> result(std::size_t(surface.count()));
  const auto lay_cap = [&](std::int32_t t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 there = surface.corner(t, k) - origin;
      result[std::size_t(t)][std::size_t(k)] = {there[of_caps.across], there[of_caps.along]};
    }
  };
  WallNumbers numbers;
  numbers.wall.assign(std::size_t(surface.count()), -1);
  numbers.place = numbers.wall;
  std::int32_t walls = 0;
  for (std::int32_t start = 0; start < surface.count(); ++start) {
    if (in_wall[std::size_t(start)] == 0) lay_cap(start);
    if (in_wall[std::size_t(start)] == 0 || numbers.wall[std::size_t(start)] >= 0) continue;
    std::vector<std::int32_t> own;
    const auto take = [&](std::int32_t t) {
      numbers.wall[std::size_t(t)] = walls;
      numbers.place[std::size_t(t)] = std::int32_t(own.size());
      own.push_back(t);
    };
    take(start);
    for (std::size_t i = 0; i < own.size(); ++i) {
      for (const std::int32_t other : surface.beside[std::size_t(own[i])])
        if (other >= 0 && in_wall[std::size_t(other)] != 0 && numbers.wall[std::size_t(other)] < 0) take(other);
    }
    if (!Wall(surface, axis, own, numbers, walls).lay(origin, result)) std::ranges::for_each(own, lay_cap);
    ++walls;
  }
  return result;
}

}  // namespace supple
