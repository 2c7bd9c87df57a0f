#include "film/pictures/surface_field.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "film/pictures/marked_vertices.h"
#include "geometry/meshes/cloth.h"
#include "render/color_map.h"
#include "scene/building/body.h"
#include "scene/definition/scene_def.h"
#include "sim/measures/fields.h"

namespace supple {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

// Describes a quantity: its name and unit in the legend, and its value at rest, where the range begins. Where the value
// at rest is in the middle, the range reaches equally far to both sides.
struct QuantityTraits {
  const char* title;
  const char* unit;
  double rest;
  bool around_mean;
};

QuantityTraits traits_of(FieldQuantity quantity) {
  switch (quantity) {
    case FieldQuantity::stretch: return {"largest stretch", "", 1, false};
    case FieldQuantity::compression: return {"compression", "", 0, false};
    case FieldQuantity::volume: return {"volume over rest", "", 1, true};
    case FieldQuantity::energy: return {"energy density", "J/m\u00b3", 0, false};
    case FieldQuantity::stress: return {"von Mises stress", "Pa", 0, false};
    case FieldQuantity::speed: return {"speed", "m/s", 0, false};
    case FieldQuantity::depth: return {"depth in colliders", "m", 0, false};
    case FieldQuantity::force: return {"contact pressure", "Pa", 0, false};
    case FieldQuantity::distance: return {"distance to reference", "m", 0, false};
    case FieldQuantity::none: break;
  }
  return {"", "", 0, false};
}

std::optional<ElementQuantity> element_quantity(FieldQuantity quantity) {
  switch (quantity) {
    case FieldQuantity::stretch: return ElementQuantity::stretch;
    case FieldQuantity::compression: return ElementQuantity::compression;
    case FieldQuantity::volume: return ElementQuantity::volume_ratio;
    case FieldQuantity::energy: return ElementQuantity::energy;
    case FieldQuantity::stress: return ElementQuantity::von_mises;
    default: return std::nullopt;
  }
}

bool body_has(FieldQuantity quantity, const Body& body) {
  // Cloth has neither stress nor energy by volume. Those of a body that flows depend on what has flowed, which
  // positions do not tell.
  return !(body.def.cloth || body.def.flows()) ||
         (quantity != FieldQuantity::energy && quantity != FieldQuantity::stress);
}

double stiffness_of(const Body& body) { return system_stiffness(body.def.substance.material, body.def.solver.fit).k; }

// Returns the weight of a body, under at least a tenth of the earth's gravity so that it is not zero [N].
double weight_of(const Body& body, const SceneDef& scene) {
  double mass = body.description.density * body.volume;
  for (const double of_vertex : body.description.point_mass) mass += of_vertex;
  return mass * std::max(scene.gravity.norm(), 1.0);
}

// Returns how far the usual range of a body reaches from the value at rest. Strains reach to half or double the length,
// stress and energy to the values at a strain of 0.3, speed to that of a fall over the body's size, contact to a
// multiple of the pressure of the body's weight where it rests, and lengths to a share of the body's size.
double usual_reach(FieldQuantity quantity, const Body& body, const SceneDef& scene) {
  constexpr double strain = 0.3, depth_share = 0.01, distance_share = 0.05, weight_share = 0.05;
  const double size = bounds_of(body.description.mesh.rest).diagonal();
  switch (quantity) {
    case FieldQuantity::stretch:
    case FieldQuantity::compression: return 1;
    case FieldQuantity::volume: return 0.5;
    case FieldQuantity::energy: return rounded_up(0.5 * strain * strain * stiffness_of(body));
    case FieldQuantity::stress: return rounded_up(strain * stiffness_of(body));
    case FieldQuantity::speed: return rounded_up(std::sqrt(2 * std::max(scene.gravity.norm(), 1.0) * size));
    case FieldQuantity::depth: return rounded_up(depth_share * size);
    case FieldQuantity::force: return rounded_up(weight_of(body, scene) / (weight_share * size * size));
    case FieldQuantity::distance: return rounded_up(distance_share * size);
    case FieldQuantity::none: break;
  }
  return 1;
}

Eigen::Vector2d range_to(FieldQuantity quantity, double reach) {
  const QuantityTraits traits = traits_of(quantity);
  return {traits.around_mean ? traits.rest - reach : traits.rest, traits.rest + reach};
}

// Returns a quantity of a cloth's triangles by vertex: the mean over the triangles, weighted by their areas at rest.
std::vector<double> on_cloth(FieldQuantity quantity, const Body& body, const Positions& x) {
  const Triangles& triangles = body.cloth.surface.triangles;
  const Positions& rest = body.description.mesh.rest;
  const auto stretches = triangle_stretches(rest, x, triangles);
  std::vector<double> sum(rest.rows(), 0.0), weight(rest.rows(), 0.0);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto [larger, smaller] = stretches[t];
    const double value = quantity == FieldQuantity::stretch       ? larger
                         : quantity == FieldQuantity::compression ? 1 - smaller
                                                                  : larger * smaller;
    if (std::isnan(value)) continue;
    const Vec3 a = rest.row(triangles(t, 0)), b = rest.row(triangles(t, 1)), c = rest.row(triangles(t, 2));
    const double area = 0.5 * (b - a).cross(c - a).norm();
    for (int k = 0; k < 3; ++k) {
      sum[triangles(t, k)] += area * value;
      weight[triangles(t, k)] += area;
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = weight[v] > 0 ? sum[v] / weight[v] : undefined;
  return sum;
}

// Returns the lengths of the rows, times a factor.
std::vector<double> lengths(const Positions& rows, double factor) {
  std::vector<double> result(rows.rows());
  for (Eigen::Index v = 0; v < rows.rows(); ++v) result[v] = factor * rows.row(v).norm();
  return result;
}

// Returns the share of each vertex in the surface of a body at rest; 0 inside [m^2].
std::vector<double> surface_areas(const Body& body) {
  const TetMesh& mesh = body.description.mesh;
  return vertex_areas({mesh.rest, surface_of(body)});
}

// Returns the contact force on each vertex over the vertex's area; 0 for a vertex without area.
std::vector<double> per_area(const Positions& forces, const std::vector<double>& areas) {
  std::vector<double> result = lengths(forces, 1);
  for (std::size_t v = 0; v < result.size(); ++v) result[v] = areas[v] > 0 ? result[v] / areas[v] : 0;
  return result;
}

}  // namespace

double rounded_up(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= value * (1 - 1e-9)) return step * power;
  }
  return 10 * power;
}

std::vector<std::pair<double, std::string>> ticks_between(double low, double high, double scale) {
  const double step = rounded_up((high - low) / 5);
  std::vector<std::pair<double, std::string>> ticks;
  for (double n = std::ceil(low / step - 1e-6); n * step <= high + 1e-6 * step; ++n) {
    const double value = n == 0 ? 0 : n * step;  // avoids a minus before a zero
    ticks.emplace_back((value - low) / (high - low), fmt::format("{:.6g}", value * scale));
  }
  return ticks;
}

SurfaceField::SurfaceField(const SceneDef& scene, const std::vector<Body>& bodies)
    : def_(scene.field), fps_(scene.fps), bodies_(bodies), elements_(bodies.size()) {
  if (def_.quantity == FieldQuantity::distance) reference_.emplace(def_.reference, scene, bodies);
  areas_.resize(bodies.size());
  double reach = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    shown_.push_back(body_has(def_.quantity, bodies[b]));
    if (!shown_.back()) continue;
    reach = std::max(reach, usual_reach(def_.quantity, bodies[b], scene));
    if (needs_forces()) areas_[b] = surface_areas(bodies[b]);
    if (element_quantity(def_.quantity) && !bodies[b].def.cloth) elements_[b].emplace(bodies[b].description);
  }
  if (reach == 0)
    throw InputError("field.quantity", fmt::format("no body of the scene has '{}': cloths have no stress and no energy "
                                                   "density, and where a body keeps dents or creeps they are in the "
                                                   "fields of --vtu alone",
                                                   name_of(def_.quantity)));
  range_ = def_.range.value_or(range_to(def_.quantity, reach));
}

std::vector<double> SurfaceField::of_body(std::size_t body, const FramePose& pose, const CollisionSet& set,
                                          Threads* threads) {
  const Positions& x = *pose.motion[body];
  if (elements_[body]) {
    std::vector<double> by_element, by_vertex;
    elements_[body]->evaluate(*element_quantity(def_.quantity), x, threads, by_element);
    elements_[body]->to_vertices(by_element, threads, by_vertex);
    return by_vertex;
  }
  if (element_quantity(def_.quantity)) return on_cloth(def_.quantity, bodies_[body], x);
  if (def_.quantity == FieldQuantity::depth) return depths_in(x, set, pose.time, 0, threads);
  if (def_.quantity == FieldQuantity::force) {
    if (pose.forces.empty() || pose.forces[body]->rows() == 0) return std::vector<double>(areas_[body].size(), 0.0);
    return per_area(*pose.forces[body], areas_[body]);
  }
  if (def_.quantity == FieldQuantity::speed) {
    const double per_second = pose.interval ? 1 / *pose.interval : fps_;
    return lengths(x - *pose.before[body], per_second);
  }
  return lengths(x - reference_->at(body, pose.frame), 1);
}

std::vector<std::vector<double>> SurfaceField::values(const FramePose& pose, const CollisionSet& set,
                                                      Threads* threads) {
  std::vector<std::vector<double>> result(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (shown_[b]) result[b] = of_body(b, pose, set, threads);
  }
  return result;
}

void SurfaceField::include(const std::vector<std::vector<double>>& values) {
  const double rest = traits_of(def_.quantity).rest;
  const bool around_mean = traits_of(def_.quantity).around_mean;
  std::vector<double> away;
  for (const std::vector<double>& body : values) {
    for (const double value : body) {
      // Few vertices touch anything, and those without a force would hide how hard the others are pressed.
      if (def_.quantity == FieldQuantity::force && value == 0) continue;
      if (!std::isnan(value)) away.push_back(around_mean ? std::abs(value - rest) : value - rest);
    }
  }
  if (away.empty()) return;
  const auto at = away.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(away.size() - 1));
  std::nth_element(away.begin(), at, away.end());
  furthest_ = std::max(furthest_, *at);
}

void SurfaceField::settle() {
  if (furthest_ > 0) range_ = range_to(def_.quantity, rounded_up(furthest_));
}

std::vector<float> SurfaceField::on_skin(const DrawnBody& drawn, const std::vector<double>& values) const {
  const bool carried = drawn.vertex_of.empty();
  const bool subdivided = drawn.weights.rows() > 0;
  const std::size_t count = carried      ? static_cast<std::size_t>(drawn.embedding.corners.rows())
                            : subdivided ? static_cast<std::size_t>(drawn.weights.rows())
                                         : drawn.vertex_of.size();
  std::vector<float> result(count, no_field);
  for (std::size_t v = 0; v < count; ++v) {
    double value = 0;
    if (carried) {
      value = embedded_value(drawn.embedding, static_cast<Eigen::Index>(v), values);
    } else if (subdivided) {
      value = weighted_value(drawn.weights, static_cast<Eigen::Index>(v), values);
    } else {
      value = values[drawn.vertex_of[v]];
    }
    const double place = (value - range_.x()) / (range_.y() - range_.x());
    if (!std::isnan(place)) result[v] = static_cast<float>(std::clamp(place, 0.0, 1.0));
  }
  return result;
}

FieldLook SurfaceField::look() const {
  const QuantityTraits traits = traits_of(def_.quantity);
  ColorMap map = traits.around_mean ? ColorMap::blue_orange : ColorMap::viridis;
  if (def_.colors == FieldColors::viridis) map = ColorMap::viridis;
  if (def_.colors == FieldColors::blue_yellow) map = ColorMap::blue_yellow;
  if (def_.colors == FieldColors::blue_orange) map = ColorMap::blue_orange;
  FieldLook look;
  look.colors = colors_of(map, 256);
  if (!def_.legend) return look;
  const std::string unit = traits.unit;
  struct Prefix {
    double from, scale;
    const char* name;
  };
  const double most = range_.cwiseAbs().maxCoeff();
  Prefix prefix{0, 1, ""};
  for (const Prefix& one : {Prefix{1e3, 1e-3, "k"}, Prefix{1e6, 1e-6, "M"}, Prefix{1e9, 1e-9, "G"}}) {
    if (!unit.empty() && most >= one.from) prefix = one;
  }
  if (unit.starts_with("m") && most < 0.1) prefix = {0, 1e3, "m"};  // lengths and speeds in millimetres
  look.title = unit.empty() ? traits.title : fmt::format("{} [{}{}]", traits.title, prefix.name, unit);
  look.ticks = ticks_between(range_.x(), range_.y(), prefix.scale);
  return look;
}

}  // namespace supple
