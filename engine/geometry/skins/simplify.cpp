#include "geometry/skins/simplify.h"

#include <meshoptimizer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

// Tells whether the border of some layer, with its soft edge, runs through a triangle or close to it.
bool carries_border(const Skin& skin, const std::vector<PaintLayer>& layers, const std::int32_t* corners) {
  for (std::size_t layer = 0; layer < layers.size(); ++layer) {
    const auto at = [&](int k) { return skin.paint[corners[k]][layer]; };
    const auto [low, high] = std::minmax({at(0), at(1), at(2)});
    const double reach = 0.5 * layers[layer].soft + (high - low);
    if (low < reach && high > -reach) return true;
  }
  return false;
}

using Cell = std::tuple<int, int, int>;

// Simplifies one group of triangles and leaves its outer edges alone, so that it still fits its neighbours.
class GroupSimplifier {
 public:
  GroupSimplifier(const Skin& skin, const std::vector<SurfaceColor>& colors)
      : skin_(skin), colors_(colors), local_(skin.rest.points.rows(), -1) {}

  // Appends what is left of the group.
  void run(const std::int32_t* group, std::size_t triangles, double error, std::vector<std::int32_t>& out) {
    names_.clear();
    places_.clear();
    indices_.clear();
    for (std::size_t i = 0; i < 3 * triangles; ++i) {
      std::int32_t& local = local_[group[i]];
      if (local < 0) {
        local = static_cast<std::int32_t>(names_.size());
        names_.push_back(group[i]);
        for (int k = 0; k < 3; ++k) places_.push_back(static_cast<float>(skin_.rest.points(group[i], k)));
      }
      indices_.push_back(static_cast<unsigned>(local));
    }
    for (const std::int32_t name : names_) local_[name] = -1;
    constexpr std::size_t stride = 3 * sizeof(float);
    const float size = meshopt_simplifyScale(places_.data(), names_.size(), stride);
    result_.resize(indices_.size());
    std::size_t left =
        size <= 0 ? 0
                  : meshopt_simplify(result_.data(), indices_.data(), indices_.size(), places_.data(), names_.size(),
                                     stride, 0, static_cast<float>(error) / size, meshopt_SimplifyLockBorder, nullptr);
    if (!colors_.empty() && left > 0 && left < indices_.size() && !keeps_colors(left, error)) left = 0;
    const std::vector<unsigned>& from = left == 0 ? indices_ : result_;
    for (std::size_t i = 0; i < (left == 0 ? indices_.size() : left); ++i) out.push_back(names_[from[i]]);
  }

 private:
  // Tells whether the colours at the vertices that were removed are still there.
  bool keeps_colors(std::size_t left, double error) const {
    std::vector<char> stays(names_.size(), 0);
    for (std::size_t i = 0; i < left; ++i) stays[result_[i]] = 1;
    for (std::size_t v = 0; v < names_.size(); ++v) {
      if (stays[v] == 0 && !finds_color(names_[v], left, error)) return false;
    }
    return true;
  }

  // Tells whether one of the triangles that are left and close to a vertex has the vertex's colour there.
  bool finds_color(std::int32_t vertex, std::size_t left, double error) const {
    const Vec3 place = skin_.rest.points.row(vertex);
    for (std::size_t i = 0; i < left; i += 3) {
      std::array<std::int32_t, 3> corners;
      Positions points(3, 3);
      for (int k = 0; k < 3; ++k) {
        corners[std::size_t(k)] = names_[result_[i + std::size_t(k)]];
        points.row(k) = skin_.rest.points.row(corners[std::size_t(k)]);
      }
      const Vec3 a = points.row(0), b = points.row(1), c = points.row(2), at = closest_in_triangle(place, a, b, c);
      if ((at - place).squaredNorm() > 4 * error * error) continue;
      if (alike(colors_[std::size_t(vertex)], corners, points, weights_in_triangle(at, a, b, c), error)) return true;
    }
    return false;
  }

  bool alike(const SurfaceColor& color, const std::array<std::int32_t, 3>& corners, const Positions& points,
             const Vec3& weights, double error) const {
    const auto of = [&](std::size_t k) -> const SurfaceColor& { return colors_[std::size_t(corners[k])]; };
    const auto mixed = [&](float SurfaceColor::*part) {
      return weights[0] * of(0).*part + weights[1] * of(1).*part + weights[2] * of(2).*part;
    };
    for (float SurfaceColor::*part : {&SurfaceColor::red, &SurfaceColor::green, &SurfaceColor::blue}) {
      constexpr double shade = 0.02;  // in roots of linear light, which are about as far apart as they look
      if (std::abs(std::sqrt(mixed(part)) - std::sqrt(double(color.*part))) > shade) return false;
    }
    if (color.texture != of(0).texture) return false;
    if (color.texture < 0) return true;
    // Lengths on the surface over those in the texture: the root of the ratio of the areas.
    const Vec3 side = points.row(1) - points.row(0), other = points.row(2) - points.row(0);
    const double u1 = of(1).u - of(0).u, v1 = of(1).v - of(0).v, u2 = of(2).u - of(0).u, v2 = of(2).v - of(0).v;
    const double area = std::abs(u1 * v2 - u2 * v1),
                 off = std::hypot(mixed(&SurfaceColor::u) - color.u, mixed(&SurfaceColor::v) - color.v);
    return off * std::sqrt(side.cross(other).norm()) <= error * std::sqrt(area);
  }

  const Skin& skin_;
  const std::vector<SurfaceColor>& colors_;
  std::vector<std::int32_t> local_, names_;  // by vertex: its place in the group or -1; by place: the vertex
  std::vector<float> places_;
  std::vector<unsigned> indices_, result_;
};

// Sorts triangles by the cell of a grid that holds their middle, and simplifies each cell's own.
std::vector<std::int32_t> simplified_by_cells(const Skin& skin, const std::vector<SurfaceColor>& colors,
                                              const std::vector<std::int32_t>& corners, double cell, double shift,
                                              double error) {
  std::vector<std::pair<Cell, std::size_t>> order;
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const Vec3 middle = (skin.rest.points.row(corners[t]) + skin.rest.points.row(corners[t + 1]) +
                         skin.rest.points.row(corners[t + 2])) /
                        3;
    const auto at = [&](int k) { return static_cast<int>(std::floor(middle[k] / cell + shift)); };
    order.push_back({Cell{at(0), at(1), at(2)}, t});
  }
  std::ranges::sort(order);
  GroupSimplifier simplifier(skin, colors);
  std::vector<std::int32_t> group, result;
  for (std::size_t i = 0; i < order.size();) {
    group.clear();
    std::size_t end = i;
    for (; end < order.size() && order[end].first == order[i].first; ++end)
      group.insert(group.end(), &corners[order[end].second], &corners[order[end].second] + 3);
    simplifier.run(group.data(), group.size() / 3, error, result);
    i = end;
  }
  return result;
}

}  // namespace

Triangles simplified(const Skin& skin, double error, double longest, const std::vector<PaintLayer>& layers,
                     const std::vector<SurfaceColor>& colors) {
  std::vector<std::int32_t> plain, bordering;
  for (Eigen::Index t = 0; t < skin.rest.triangles.rows(); ++t) {
    const std::int32_t* corners = skin.rest.triangles.row(t).data();
    std::vector<std::int32_t>& where = carries_border(skin, layers, corners) ? bordering : plain;
    where.insert(where.end(), corners, corners + 3);
  }
  // A pass leaves the edges between two cells alone. The next one shifts the grid, so that these edges lie within a
  // cell and can be simplified. The errors of the passes add up.
  constexpr int passes = 3;
  for (int pass = 0; pass < passes; ++pass)
    plain = simplified_by_cells(skin, colors, plain, longest, static_cast<double>(pass) / passes, error / passes);
  plain.insert(plain.end(), bordering.begin(), bordering.end());
  // Triangles that share vertices follow each other, so that a rasteriser computes few vertices twice.
  Triangles result(static_cast<Eigen::Index>(plain.size() / 3), 3);
  const auto* corners = reinterpret_cast<const unsigned*>(plain.data());
  meshopt_optimizeVertexCache(reinterpret_cast<unsigned*>(result.data()), corners, plain.size(),
                              static_cast<std::size_t>(skin.rest.points.rows()));
  return result;
}

std::vector<std::int32_t> remove_unused_vertices(Skin& skin) {
  std::vector<std::int32_t> place(skin.rest.points.rows(), -1), kept;
  for (Eigen::Index i = 0; i < skin.rest.triangles.size(); ++i) place[skin.rest.triangles.data()[i]] = 0;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] < 0) continue;
    place[v] = static_cast<std::int32_t>(kept.size());
    kept.push_back(static_cast<std::int32_t>(v));
  }
  for (Eigen::Index i = 0; i < skin.rest.triangles.size(); ++i)
    skin.rest.triangles.data()[i] = place[skin.rest.triangles.data()[i]];
  const auto keep = [&kept](auto& values) {
    if (values.empty()) return;
    for (std::size_t v = 0; v < kept.size(); ++v) values[v] = values[kept[v]];
    values.resize(kept.size());
  };
  keep(skin.occlusion);
  keep(skin.paint);
  keep(skin.square);
  keep(skin.color);
  keep(skin.smooth);
  for (std::size_t v = 0; v < kept.size(); ++v)
    skin.rest.points.row(static_cast<Eigen::Index>(v)) = skin.rest.points.row(kept[v]).eval();
  skin.rest.points.conservativeResize(static_cast<Eigen::Index>(kept.size()), 3);
  return kept;
}

}  // namespace supple
