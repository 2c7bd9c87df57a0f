#include "scene/building/skin_overhang.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>

#include "geometry/triangles/moving_surface.h"

namespace supple {
namespace {

constexpr double furthest_skin = 0.01;  // over the body's size
constexpr double most = 0.004;          // the largest that counts, over the size; larger ones let impacts gain energy
constexpr int smoothings = 3;           // a step cannot foresee how the overhang changes along the surface

// Finds how far the skin is from places of the elements' surface, in the file's frame and units.
class SkinAbove {
 public:
  explicit SkinAbove(const Body& body) : shape_(body.shape) {
    if (body.shape.root.parts.empty()) surface_.emplace(body.skin.triangles, body.skin.points);
  }

  // Returns the way from a place to the skin along a direction of unit length; 0 where the place is outside the skin or
  // the way is longer than `furthest`.
  double way(const Vec3& place, const Vec3& direction, double furthest) const {
    if (surface_) {
      const auto exit = surface_->last_exit_at_start(place, place + furthest * direction);
      return exit ? exit->share * furthest : 0;
    }
    constexpr int most_steps = 100;
    constexpr double near = 1e-3;  // over `furthest`
    double gone = 0;
    for (int i = 0; i < most_steps && gone <= furthest; ++i) {
      const double inside = -shape_.distance(place + gone * direction);
      if (inside < near * furthest) return gone;
      gone += inside;
    }
    return 0;
  }

 private:
  const Shape& shape_;
  std::optional<MovingSurface> surface_;
};

// Puts the mean over the triangles at each vertex in the place of its value.
void smooth(const Triangles& surface, std::vector<double>& values) {
  std::vector<double> sum(values.size()), count(values.size());
  for (const auto& t : surface.rowwise()) {
    double mean = 0;
    for (int k = 0; k < 3; ++k) mean += values[std::size_t(t[k])] / 3;
    for (int k = 0; k < 3; ++k) {
      sum[std::size_t(t[k])] += mean;
      count[std::size_t(t[k])] += 1;
    }
  }
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (count[v] > 0) values[v] = sum[v] / count[v];
  }
}

}  // namespace

std::vector<double> skin_overhang(const Body& body) {
  if (body.skin.triangles.rows() == 0 && body.shape.root.parts.empty()) return {};
  constexpr double half = 0.5, third = 1.0 / 3;
  static const std::array<Vec3, 7> places = {Vec3(1, 0, 0),
                                             Vec3(0, 1, 0),
                                             Vec3(0, 0, 1),
                                             Vec3(half, half, 0),
                                             Vec3(half, 0, half),
                                             Vec3(0, half, half),
                                             Vec3(third, third, third)};
  const SkinAbove skin(body);
  const Triangles surface = surface_of(body);
  const Positions& points = body.description.mesh.rest;
  const double size = bounds_of(points).diagonal(), furthest = furthest_skin * size;
  std::vector<double> overhang(std::size_t(points.rows()));
  for (const auto& t : surface.rowwise()) {
    Mat3 corners;  // by column
    for (int k = 0; k < 3; ++k) corners.col(k) = points.row(t[k]).transpose();
    const Vec3 normal = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
    if (!(normal.norm() > 0)) continue;
    for (const Vec3& place : places) {
      const double way = std::min(skin.way(corners * place, normal.normalized(), furthest), most * size);
      for (int k = 0; k < 3; ++k) {
        double& most_there = overhang[std::size_t(t[k])];
        most_there = std::max(most_there, way);
      }
    }
  }
  for (int round = 0; round < smoothings; ++round) smooth(surface, overhang);
  return overhang;
}

}  // namespace supple
