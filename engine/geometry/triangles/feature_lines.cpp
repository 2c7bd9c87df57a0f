#include "geometry/triangles/feature_lines.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/disjoint_sets.h"
#include "geometry/triangles/line_corners.h"
#include "geometry/triangles/numbered_surface.h"
#include "geometry/triangles/triangle_edges.h"

namespace supple {
namespace {

struct FeatureEdge {
  std::int32_t low, high;
  std::size_t triangles;  // how many have it
};

class FeatureSearch {
 public:
  FeatureSearch(const TriMesh& mesh, const std::vector<std::array<std::int32_t, 2>>& named, const FeatureLimits& limits)
      : mesh_(mesh),
        limits_(limits),
        sides_(sorted_edges(mesh.triangles)),
        fans_(3 * at(mesh.triangles.rows())),
        patches_(at(mesh.triangles.rows())),
        edges_at_(at(mesh.points.rows())) {
    sort_edges(named);
    find_corners();
    find_patches();
  }

  SurfaceFeatures take() {
    std::vector<char> followed(edges_.size(), 0);
    // Lines start at corners; those that are left have none and are closed.
    for (const bool at_corners : {true, false}) {
      for (std::int32_t v = 0; v < std::int32_t(edges_at_.size()); ++v) {
        if (at_corners && !result_.is_corner[at(v)]) continue;
        for (const std::size_t edge : edges_at_[at(v)])
          if (!followed[edge]) add_line(follow(v, edge, followed));
      }
    }
    name_sides();
    return std::move(result_);
  }

 private:
  // Divides the edges into those on lines and those inside patches.
  void sort_edges(const std::vector<std::array<std::int32_t, 2>>& named) {
    std::vector<std::size_t> creases;  // by their first sides; whether they are on a line is decided later
    for (std::size_t i = 0, end = 0; i < sides_.size(); i = end) {
      const TriangleEdge& first = sides_[i];
      for (end = i + 1; end < sides_.size() && sides_[end].low == first.low && sides_[end].high == first.high;) ++end;
      for (std::size_t other = i + 1; other < end; ++other) {
        for (const bool upper : {false, true}) fans_.join(corner_at(first, upper), corner_at(sides_[other], upper));
      }
      const bool is_named = std::ranges::binary_search(named, std::array{first.low, first.high});
      const bool turns_over = end - i == 2 && first.upward == sides_[i + 1].upward;
      if (end - i != 2 || is_named || turns_over) {
        put_on_line(i, end - i);
      } else if (is_crease(first, sides_[i + 1])) {
        creases.push_back(i);
      } else {
        patches_.join(at(first.triangle), at(sides_[i + 1].triangle));
      }
    }
    sort_creases(creases);
  }

  void sort_creases(const std::vector<std::size_t>& creases) {
    DisjointSets connected(edges_at_.size());
    for (const std::size_t i : creases) connected.join(at(sides_[i].low), at(sides_[i].high));
    std::map<std::size_t, double> lengths;
    for (const std::size_t i : creases)
      lengths[connected.of(at(sides_[i].low))] +=
          (mesh_.points.row(sides_[i].low) - mesh_.points.row(sides_[i].high)).norm();
    for (const std::size_t i : creases) {
      if (lengths[connected.of(at(sides_[i].low))] > limits_.shortest) {
        put_on_line(i, 2);
      } else {
        patches_.join(at(sides_[i].triangle), at(sides_[i + 1].triangle));
      }
    }
  }

  void put_on_line(std::size_t side, std::size_t triangles) {
    for (const std::int32_t v : {sides_[side].low, sides_[side].high}) edges_at_[at(v)].push_back(edges_.size());
    edges_.push_back({sides_[side].low, sides_[side].high, triangles});
  }

  // Returns the number, among the corners of all triangles, of that corner of the side's triangle which is at the upper
  // or at the lower vertex of the side.
  static std::size_t corner_at(const TriangleEdge& side, bool upper) {
    const int k = side.upward == upper ? (side.side + 1) % 3 : side.side;
    return 3 * at(side.triangle) + std::size_t(k);
  }

  bool is_crease(const TriangleEdge& a, const TriangleEdge& b) const {
    const Vec3 m = area_vector(mesh_, a.triangle), n = area_vector(mesh_, b.triangle);
    if (is_thin(a.triangle, m) || is_thin(b.triangle, n)) return false;
    return std::atan2(m.cross(n).norm(), m.dot(n)) > limits_.crease;
  }

  // Tells whether a triangle is so thin that its normal shows no crease. The normals of triangles that are nearly flat
  // are noise: coordinates in a file often have seven digits. Those of longish triangles that are far thinner than the
  // shortest crease is long show nothing that matters at that scale.
  bool is_thin(std::int32_t t, const Vec3& area) const {
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (corner(mesh_, t, k) - corner(mesh_, t, (k + 1) % 3)).norm());
    const double height = 2 * area.norm() / longest;
    return height < 1e-5 * longest || (height < 1e-2 * longest && height < 1e-2 * limits_.shortest);
  }

  // Flags the vertices that are corners. A vertex is no corner if its triangles hang together through edges at it, and
  // if either no line runs through it, or one line along which the number of triangles at an edge stays the same there.
  void find_corners() {
    std::vector<std::int32_t> fans(edges_at_.size(), 0);
    for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const std::size_t own = 3 * at(t) + std::size_t(k);
        if (fans_.of(own) == own) ++fans[at(mesh_.triangles(t, k))];
      }
    }
    result_.is_corner.assign(edges_at_.size(), 0);
    for (std::size_t v = 0; v < edges_at_.size(); ++v) {
      const std::vector<std::size_t>& own = edges_at_[v];
      const bool passes = own.size() == 2 && edges_[own[0]].triangles == edges_[own[1]].triangles;
      result_.is_corner[v] = fans[v] > 1 || !(own.empty() || passes);
    }
  }

  void find_patches() {
    std::vector<std::int32_t> number(patches_.size(), -1);
    for (std::size_t t = 0; t < number.size(); ++t) {
      std::int32_t& own = number[patches_.of(t)];
      if (own < 0) own = result_.patches++;
      result_.patch.push_back(own);
    }
  }

  // Lists the vertices of a line from a vertex to the next corner, or back to the same vertex.
  std::vector<std::int32_t> follow(std::int32_t start, std::size_t edge, std::vector<char>& followed) const {
    std::vector<std::int32_t> vertices{start};
    for (;;) {
      followed[edge] = 1;
      const std::int32_t last = vertices.back();
      const std::int32_t next = edges_[edge].low == last ? edges_[edge].high : edges_[edge].low;
      vertices.push_back(next);
      if (next == start || result_.is_corner[at(next)]) return vertices;
      const std::vector<std::size_t>& own = edges_at_[at(next)];
      edge = own[0] == edge ? own[1] : own[0];
    }
  }

  // Cuts a row of vertices at its corners.
  void add_line(const std::vector<std::int32_t>& row) {
    const bool closed = row.front() == row.back();
    const std::vector<std::size_t> cuts = line_corners(row, mesh_.points, result_.is_corner, limits_);
    for (const std::size_t i : cuts) result_.is_corner[at(row[i])] = 1;
    for (std::size_t c = 0; c + (closed ? 0 : 1) < cuts.size(); ++c) {
      FeatureLine line;
      const std::size_t end = c + 1 < cuts.size() ? cuts[c + 1] : cuts[0] + row.size() - 1;
      for (std::size_t i = cuts[c]; i <= end; ++i) {
        const std::int32_t v = row[i < row.size() ? i : i - row.size() + 1];
        const double step =
            line.vertices.empty() ? 0 : (mesh_.points.row(v) - mesh_.points.row(line.vertices.back())).norm();
        line.along.push_back(line.along.empty() ? 0 : line.along.back() + step);
        line.vertices.push_back(v);
      }
      result_.lines.push_back(std::move(line));
    }
  }

  void name_sides() {
    std::map<std::array<std::int32_t, 2>, std::int32_t> names;
    for (std::size_t line = 0; line < result_.lines.size(); ++line) {
      const std::vector<std::int32_t>& row = result_.lines[line].vertices;
      for (std::size_t i = 1; i < row.size(); ++i)
        names[{std::min(row[i - 1], row[i]), std::max(row[i - 1], row[i])}] = std::int32_t(line);
    }
    result_.line_of.assign(at(mesh_.triangles.rows()), {-1, -1, -1});
    for (const TriangleEdge& side : sides_) {
      const auto found = names.find({side.low, side.high});
      if (found != names.end()) result_.line_of[at(side.triangle)][at(side.side)] = found->second;
    }
  }

  const TriMesh& mesh_;
  const FeatureLimits limits_;
  const std::vector<TriangleEdge> sides_;
  DisjointSets fans_;                               // sets of corners, three for each triangle, that edges connect
  DisjointSets patches_;                            // sets of triangles that edges on no line connect
  std::vector<std::vector<std::size_t>> edges_at_;  // by vertex: its edges on lines
  std::vector<FeatureEdge> edges_;                  // all edges on lines
  SurfaceFeatures result_;
};

}  // namespace

SurfaceFeatures features_of(const TriMesh& mesh, const std::vector<std::array<std::int32_t, 2>>& named,
                            const FeatureLimits& limits) {
  std::vector<std::array<std::int32_t, 2>> in_order = named;
  std::ranges::sort(in_order);
  return FeatureSearch(mesh, in_order, limits).take();
}

std::size_t segment_of(const FeatureLine& line, double along) {
  const auto after = std::upper_bound(line.along.begin() + 1, line.along.end() - 1, along);
  return std::size_t(after - line.along.begin()) - 1;
}

Vec3 point_of(const FeatureLine& line, double along, const Positions& points) {
  const std::size_t i = segment_of(line, along);
  const double share = std::clamp((along - line.along[i]) / (line.along[i + 1] - line.along[i]), 0.0, 1.0);
  return (1 - share) * points.row(line.vertices[i]) + share * points.row(line.vertices[i + 1]);
}

}  // namespace supple
