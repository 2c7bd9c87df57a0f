#include "live/pick.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/view.h"
#include "sim/materials/material.h"

namespace supple {
namespace {

constexpr double reach = 0.05;      // of the vertices around the place that are grabbed, over the body's size
constexpr double near_miss = 0.02;  // of a pointer beside a body, over the picture's height

struct Ray {
  Vec3 from, along;  // along the viewing direction, `along` has length one
};

Ray ray_at(const Camera& camera, double aspect, const Eigen::Vector2d& place) {
  constexpr int pixels = 1 << 20;  // as fine as pointers are
  const auto width = static_cast<int>(pixels * aspect);
  const Rays rays = rays_through(camera, width, pixels);
  return {camera.eye, rays.corner + place.x() * width * rays.right + (1 - place.y()) * pixels * rays.up};
}

// Returns where a ray meets a triangle, as its parameter (Moeller and Trumbore 1997).
std::optional<double> hit(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = ray.along.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0) return std::nullopt;
  const Vec3 from_a = ray.from - a, q = from_a.cross(ab);
  const double u = from_a.dot(p) / determinant, v = ray.along.dot(q) / determinant, t = ac.dot(q) / determinant;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && t > 0)) return std::nullopt;
  return t;
}

struct Found {
  std::size_t body = 0;
  double at = std::numeric_limits<double>::infinity();  // parameter of the ray
};

Found first_hit(const World& world, const Ray& ray) {
  Found found;
  for (std::size_t b = 0; b < world.size(); ++b) {
    const Positions& x = world.body(b).state().x;
    const Triangles& surface = world.body(b).model().surface;
    for (Eigen::Index t = 0; t < surface.rows(); ++t) {
      const auto at = hit(ray, x.row(surface(t, 0)), x.row(surface(t, 1)), x.row(surface(t, 2)));
      if (at && *at < found.at) found = {b, *at};
    }
  }
  return found;
}

// Finds the vertex that a ray passes closest by, for pointers just beside a body: skins reach beyond the elements.
Found nearest_beside(const World& world, const Ray& ray, double height_over_distance) {
  Found found;
  double least = near_miss;
  for (std::size_t b = 0; b < world.size(); ++b) {
    const Positions& x = world.body(b).state().x;
    for (Eigen::Index v = 0; v < x.rows(); ++v) {
      const Vec3 from = x.row(v).transpose() - ray.from;
      const double at = from.dot(ray.along) / ray.along.squaredNorm();
      const double beside = (from - at * ray.along).norm() / (at * height_over_distance);
      if (at <= 0 || beside >= least) continue;
      least = beside;
      found = {b, at};
    }
  }
  return found;
}

// Returns the stiffness of all springs together [N/m], which is that of a hand: several times that with which an
// elastic half space resists a disc of this radius (some 4 mu r for a soft one: Johnson, Contact Mechanics, 1985,
// section 3.4), so that a soft ear comes along; but at most so much that the body's weight would hang a fiftieth of its
// size below the pointer, so that nobody pulls a stiff body apart.
double stiffness_of_grip(const World& world, std::size_t b, double radius) {
  const Body& body = world.bodies()[b];
  const Model& model = world.body(b).model();
  double k = 0;  // of equation 11, some 2 mu; that of the stiffest material [Pa]
  for (const Material& material : body.description.materials)
    k = std::max(k, system_stiffness(material, body.description.fit).k);
  const double weight = model.total_mass * 9.81;
  return std::min(5 * k * radius, 50 * weight / model.size);
}

}  // namespace

std::optional<Pick> pick(const World& world, const Camera& camera, double aspect, const Eigen::Vector2d& place) {
  const Ray ray = ray_at(camera, aspect, place);
  Found found = first_hit(world, ray);
  if (!std::isfinite(found.at)) {
    const double height_over_distance = 2 * std::tan(camera.fov_deg * std::numbers::pi / 360);
    found = nearest_beside(world, ray, height_over_distance);
  }
  if (!std::isfinite(found.at)) return std::nullopt;
  Pick pick{found.body, ray.from + found.at * ray.along, {}, 0};
  const MovingBody& body = world.body(found.body);
  const Positions x = in_input_order(body.model(), body.state().x);
  const double radius = reach * body.model().size;
  int nearest = 0;
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const double distance = (x.row(v).transpose() - pick.place).norm();
    if (distance < radius) pick.vertices.push_back(int(v) + 1);
    if (distance < (x.row(nearest).transpose() - pick.place).norm()) nearest = int(v);
  }
  if (pick.vertices.empty()) pick.vertices.push_back(nearest + 1);
  pick.stiffness = stiffness_of_grip(world, found.body, radius) / double(pick.vertices.size());
  return pick;
}

Vec3 point_in_plane(const Camera& camera, double aspect, const Eigen::Vector2d& place, const Vec3& point) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Ray ray = ray_at(camera, aspect, place);
  return ray.from + (point - camera.eye).dot(forward) * ray.along;
}

double picture_height_at(const Camera& camera, const Vec3& point) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  return 2 * (point - camera.eye).dot(forward) * std::tan(camera.fov_deg * std::numbers::pi / 360);
}

}  // namespace supple
