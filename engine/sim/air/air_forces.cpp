#include "sim/air/air_forces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/air/enclosed_volume.h"
#include "sim/air/wind_field.h"
#include "sim/model/vertex_chunks.h"

namespace supple {
namespace {

constexpr int triangles_a_chunk = 512;
constexpr int sums_a_chunk = 3;  // of drag, of the volume, of the volume's change

int chunks_of(std::int32_t triangles) { return (triangles + triangles_a_chunk - 1) / triangles_a_chunk; }

double cube(double of_square) { return of_square * std::sqrt(of_square); }

// Returns |a|^3 - |b|^3 with the digits of the difference `apart` = a - b, where a + b is `both`.
double cubes_apart(const Vec3& apart, const Vec3& both) {
  const double a = 0.5 * (both + apart).norm(), b = 0.5 * (both - apart).norm();
  return a + b > 0 ? apart.dot(both) / (a + b) * (a * a + a * b + b * b) : 0;
}

}  // namespace

void AirForces::remember_structure(const Model& model) {
  if (structure_ == model.structure) return;
  structure_ = model.structure;
  rest_volume_.clear();
  int chunks = vertex_chunks(model);
  for (const Part& part : model.parts) {
    rest_volume_.push_back(signed_volume(model.surface, part.first_triangle, part.triangles, model.rest));
    chunks = std::max(chunks, chunks_of(part.triangles));
  }
  partial_.resize(std::size_t(chunks) * sums_a_chunk);
  const auto triangles = static_cast<std::size_t>(model.surface.rows());
  facets_.resize(triangles);
  third_of_drag_.resize(triangles);
  areas_.resize(triangles);
  fan_begin_.assign(std::size_t(model.free) + 1, 0);
  const auto for_each_free_corner = [&](const auto& visit) {
    for (std::int32_t t = 0; t < model.surface.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (model.surface(t, k) < model.free) visit(std::size_t(model.surface(t, k)), t);
      }
    }
  };
  for_each_free_corner([&](std::size_t v, std::int32_t) { ++fan_begin_[v + 1]; });
  for (std::size_t v = 0; v < std::size_t(model.free); ++v) fan_begin_[v + 1] += fan_begin_[v];
  fan_.resize(std::size_t(fan_begin_.back()));
  std::vector<std::int32_t> next(fan_begin_.begin(), fan_begin_.end() - 1);
  for_each_free_corner([&](std::size_t v, std::int32_t t) { fan_[std::size_t(next[v]++)] = t; });
}

void AirForces::begin(const Model& model, const StepInputs& inputs, const Positions& q, double time) {
  parts_.clear();
  fixed_.clear();
  have_drag_ = have_gas_ = false;
  if (inputs.air.empty()) return;
  SUPPLE_CHECK(inputs.air.size(), ==, model.parts.size());
  remember_structure(model);
  start_ = q;
  h_ = model.time_step;
  scheme_ = model.scheme;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartAir& air = inputs.air[p];
    const bool drags = air.drag.act() && inputs.wind.density > 0;
    if (!drags && !air.gas) continue;
    constexpr double share_of_side = 0.5;  // a solid has a triangle on either side
    const double half_density = 0.5 * inputs.wind.density * (model.parts[p].solid ? share_of_side : 1);
    const double sign = rest_volume_[p] < 0 ? -1 : 1;
    parts_.push_back({.part = p,
                      .drags = drags,
                      .has_gas = air.gas.has_value(),
                      .across = half_density * air.drag.normal,
                      .along = half_density * air.drag.tangent,
                      .sign = sign,
                      .law = GasLaw(air.gas.value_or(GasFilling{}), sign * rest_volume_[p]),
                      .volume_slope = 0});
    if (drags) set_facets(model, parts_.back(), inputs.wind, time);
    if (air.gas && air.gas->amount == GasAmount::fixed) fixed_.push_back(parts_.size() - 1);
    have_drag_ |= drags;
    have_gas_ |= air.gas.has_value();
  }
}

void AirForces::set_facets(const Model& model, const ActivePart& part, const Wind& wind, double time) {
  const WindField field(wind);
  const Part& of = model.parts[part.part];
  for (Eigen::Index t = of.first_triangle; t < of.first_triangle + of.triangles; ++t) {
    const Vec3 a = start_.row(model.surface(t, 0)), b = start_.row(model.surface(t, 1)),
               c = start_.row(model.surface(t, 2));
    const Vec3 across = (b - a).cross(c - a);
    const double twice = across.norm();
    facets_[std::size_t(t)] = {twice > 0 ? Vec3(across / twice) : Vec3(Vec3::Zero()), field.at((a + b + c) / 3, time),
                               0.5 * twice};
  }
}

Vec3 AirForces::beyond_wind(const Model& model, Eigen::Index t, const Positions& x) const {
  Vec3 way = Vec3::Zero();
  for (int k = 0; k < 3; ++k) way += (x.row(model.surface(t, k)) - start_.row(model.surface(t, k))).transpose();
  return way / (3 * h_) - facets_[std::size_t(t)].wind;
}

Vec3 AirForces::drag_force(const ActivePart& part, Eigen::Index t, const Vec3& beyond) const {
  const Facet& facet = facets_[std::size_t(t)];
  const double across = facet.normal.dot(beyond);
  const Vec3 along = beyond - across * facet.normal;
  return -facet.area * (part.across * std::abs(across) * across * facet.normal + part.along * along.norm() * along);
}

double AirForces::drag_value(const ActivePart& part, Eigen::Index t, const Vec3& beyond) const {
  const Facet& facet = facets_[std::size_t(t)];
  const double across = facet.normal.dot(beyond);
  const Vec3 along = beyond - across * facet.normal;
  return h_ / 3 * facet.area * (part.across * cube(across * across) + part.along * cube(along.squaredNorm()));
}

Vec3 AirForces::middle(const Positions& x, std::int32_t vertex) const {
  if (scheme_.theta == 1) return x.row(vertex);
  return scheme_.theta * x.row(vertex) + (1 - scheme_.theta) * start_.row(vertex);
}

Vec3 AirForces::area_vector(const Model& model, Eigen::Index t, const Positions& x) const {
  const Vec3 a = middle(x, model.surface(t, 0));
  return 0.5 * (middle(x, model.surface(t, 1)) - a).cross(middle(x, model.surface(t, 2)) - a);
}

// Returns what drag and gas of a part add to g at x, or how that differs from the reference (null: none), and keeps the
// triangles' shares of grad D and area vectors. Let N(s) be the area vector, and d the mean way, of a triangle whose
// corners go straight from the reference (s = 0) to x (s = 1). The integral of d . N(s) over s is the volume that the
// triangle sweeps. N is quadratic in s, so that Simpson's rule gives this exactly. Over a closed surface the swept
// volumes add up to the change of its volume, with the digits of the ways.
double AirForces::evaluate_triangles(const Model& model, Threads* threads, ActivePart& part, const Positions& x,
                                     const Positions* reference) {
  const Part& of = model.parts[part.part];
  const int chunks = chunks_of(of.triangles);
  const Vec3 origin = middle(x, model.surface(of.first_triangle, 0));
  run_chunks(threads, chunks, long(of.triangles) * 60, [&](int chunk) {
    double drag = 0, volume = 0, swept = 0;
    const Eigen::Index first = of.first_triangle + Eigen::Index(chunk) * triangles_a_chunk;
    const Eigen::Index end = std::min<Eigen::Index>(first + triangles_a_chunk, of.first_triangle + of.triangles);
    for (Eigen::Index t = first; t < end; ++t) {
      Vec3 way = Vec3::Zero();  // the mean one from the reference
      for (int k = 0; k < 3 && reference != nullptr; ++k)
        way += (x.row(model.surface(t, k)) - reference->row(model.surface(t, k))).transpose() / 3;
      if (part.drags) {
        const Vec3 beyond = beyond_wind(model, t, x);
        third_of_drag_[std::size_t(t)] = drag_force(part, t, beyond) / -3;
        if (reference == nullptr) {
          drag += drag_value(part, t, beyond);
        } else {
          const Facet& facet = facets_[std::size_t(t)];
          const Vec3 apart = way / h_, both = 2 * beyond - apart;
          const Vec3 apart_across = facet.normal.dot(apart) * facet.normal;
          const Vec3 both_across = facet.normal.dot(both) * facet.normal;
          drag += h_ / 3 * facet.area *
                  (part.across * cubes_apart(apart_across, both_across) +
                   part.along * cubes_apart(apart - apart_across, both - both_across));
        }
      }
      if (part.has_gas) {
        const Vec3 area = areas_[std::size_t(t)] = area_vector(model, t, x);
        volume += (middle(x, model.surface(t, 0)) - origin).dot(area) / 3;
        if (reference == nullptr) continue;
        const Vec3 area_before = area_vector(model, t, *reference);
        Vec3 halfway[3];
        for (int k = 0; k < 3; ++k)
          halfway[k] = 0.5 * (middle(x, model.surface(t, k)) + middle(*reference, model.surface(t, k)));
        const Vec3 area_halfway = 0.5 * (halfway[1] - halfway[0]).cross(halfway[2] - halfway[0]);
        swept += scheme_.theta * way.dot(area_before + 4 * area_halfway + area) / 6;
      }
    }
    double* sums = &partial_[std::size_t(chunk) * sums_a_chunk];
    sums[0] = drag;
    sums[1] = volume;
    sums[2] = swept;
  });
  double drag = 0, volume = 0, swept = 0;
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const double* sums = &partial_[std::size_t(chunk) * sums_a_chunk];
    drag += sums[0];
    volume += sums[1];
    swept += sums[2];
  }
  if (!part.has_gas) return drag;
  volume *= part.sign;
  swept *= part.sign;
  part.volume_slope = -part.sign * part.law.gauge_pressure(volume);
  return drag + scheme_.energy *
                    (reference == nullptr ? part.law.energy(volume) : part.law.energy_change(volume - swept, swept));
}

// Adds the shares of drag and gas to the gradient of a part's free vertices; returns the slope of what is added along
// the direction.
double AirForces::gather(const Model& model, Threads* threads, const ActivePart& part, const Positions& direction,
                         Positions& gradient) {
  const Part& of = model.parts[part.part];
  const int chunks = (of.free + vertices_a_chunk - 1) / vertices_a_chunk;
  run_chunks(threads, chunks, long(of.free) * 20, [&](int chunk) {
    double slope = 0;
    const int first = of.first_free + chunk * vertices_a_chunk;
    const int end = std::min(first + vertices_a_chunk, of.first_free + of.free);
    for (int v = first; v < end; ++v) {
      Vec3 sum = Vec3::Zero(), area = Vec3::Zero();
      for (std::int32_t i = fan_begin_[std::size_t(v)]; i < fan_begin_[std::size_t(v) + 1]; ++i) {
        const auto t = static_cast<std::size_t>(fan_[std::size_t(i)]);
        if (part.drags) sum += third_of_drag_[t];
        if (part.has_gas) area += areas_[t];
      }
      // The factor of the energy and that of the middle's derivative cancel: e theta = 1 for both integrators.
      if (part.has_gas) sum += part.volume_slope / 3 * area;
      gradient.row(v) += sum.transpose();
      slope += direction.row(v).dot(sum);
    }
    partial_[std::size_t(chunk)] = slope;
  });
  double slope = 0;
  for (int chunk = 0; chunk < chunks; ++chunk) slope += partial_[std::size_t(chunk)];
  return slope;
}

AirChange AirForces::add(const Model& model, Threads* threads, const Positions& x, const Positions* reference,
                         const Positions& direction, Positions* gradient) {
  AirChange change;
  for (ActivePart& part : parts_) {
    change.value += evaluate_triangles(model, threads, part, x, reference);
    if (gradient != nullptr) change.slope += gather(model, threads, part, direction, *gradient);
  }
  return change;
}

}  // namespace supple
