// Computes what is asked of the air beside the objective: energies and work, second derivatives, and free ways.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/air/air_forces.h"
#include "sim/air/enclosed_volume.h"

namespace supple {
namespace {

// Returns the matrix of the cross product v x.
Mat3 cross_by(const Vec3& v) {
  Mat3 matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

// Returns the derivative of |a| a by a.
Mat3 derivative_of_square(const Vec3& a) {
  const double length = a.norm();
  if (length == 0) return Mat3::Zero();
  return length * Mat3::Identity() + a * a.transpose() / length;
}

}  // namespace

double AirForces::volume(const Model& model, const ActivePart& part, const Positions& x) const {
  const Part& of = model.parts[part.part];
  if (scheme_.theta == 1) return part.sign * signed_volume(model.surface, of.first_triangle, of.triangles, x);
  const Positions between = scheme_.theta * x + (1 - scheme_.theta) * start_;
  return part.sign * signed_volume(model.surface, of.first_triangle, of.triangles, between);
}

double AirForces::drag_energy(const Model& model, const Positions& x) const {
  double sum = 0;
  for (const ActivePart& part : parts_) {
    if (!part.drags) continue;
    const Part& of = model.parts[part.part];
    for (Eigen::Index t = of.first_triangle; t < of.first_triangle + of.triangles; ++t)
      sum += drag_value(part, t, beyond_wind(model, t, x));
  }
  return sum;
}

double AirForces::gas_energy(const Model& model, const Positions& x) const {
  double sum = 0;
  for (const ActivePart& part : parts_) {
    const Part& of = model.parts[part.part];
    if (part.has_gas)
      sum += part.law.energy(part.sign * signed_volume(model.surface, of.first_triangle, of.triangles, x));
  }
  return sum;
}

double AirForces::work(const Model& model, const Positions& x) const {
  double sum = 0;
  for (const ActivePart& part : parts_) {
    const Part& of = model.parts[part.part];
    const double pressure = part.has_gas ? part.law.gauge_pressure(volume(model, part, x)) : 0;
    for (Eigen::Index t = of.first_triangle; t < of.first_triangle + of.triangles; ++t) {
      Vec3 free_way = Vec3::Zero(), held_way = Vec3::Zero();
      for (const std::int32_t v : model.surface.row(t))
        (v < model.free ? free_way : held_way) += (x.row(v) - start_.row(v)).transpose();
      if (part.drags) sum += drag_force(part, t, beyond_wind(model, t, x)).dot(free_way) / 3;
      if (part.has_gas && !held_way.isZero(0)) sum -= part.sign * pressure * area_vector(model, t, x).dot(held_way) / 3;
    }
  }
  return sum;
}

const AirForces::ActivePart* AirForces::active_part_of(const Model& model, std::int32_t vertex) const {
  const std::size_t number = model.part_number(vertex);
  const auto found = std::ranges::find(parts_, number, &ActivePart::part);
  return found == parts_.end() ? nullptr : &*found;
}

AirForces::VertexShare AirForces::share_of(const Model& model, const Positions& x, std::int32_t vertex) const {
  VertexShare share{Vec3::Zero(), 0};
  const ActivePart* part = active_part_of(model, vertex);
  if (part == nullptr) return share;
  for (std::int32_t i = fan_begin_[std::size_t(vertex)]; i < fan_begin_[std::size_t(vertex) + 1]; ++i) {
    const Eigen::Index t = fan_[std::size_t(i)];
    if (part->drags) {
      const Vec3 beyond = beyond_wind(model, t, x);
      share.slope -= drag_force(*part, t, beyond) / 3;
      share.stiffness +=
          2 * std::max(part->across, part->along) * facets_[std::size_t(t)].area * beyond.norm() / (9 * h_);
    }
    if (part->has_gas) share.slope += part->volume_slope / 3 * area_vector(model, t, x);
  }
  return share;
}

void AirForces::add_stiffness(const Model& model, const Positions& x, bool project, ElasticHessian& hessian) const {
  for (const ActivePart& part : parts_) {
    const Part& of = model.parts[part.part];
    const bool by_volume = part.has_gas && !project;
    const double slope = by_volume ? -part.sign * part.law.gauge_pressure(volume(model, part, x)) : 0;
    for (Eigen::Index t = of.first_triangle; t < of.first_triangle + of.triangles; ++t) {
      Mat3 drag = Mat3::Zero();
      if (part.drags) {
        const Facet& facet = facets_[std::size_t(t)];
        const Vec3 beyond = beyond_wind(model, t, x), across = facet.normal.dot(beyond) * facet.normal;
        const Mat3 normal = facet.normal * facet.normal.transpose();
        const Mat3 plane = Mat3::Identity() - normal;
        drag = facet.area / (9 * h_) *
               (2 * part.across * across.norm() * normal +
                part.along * plane * derivative_of_square(beyond - across) * plane);
      }
      for (int j = 0; j < 3; ++j) {
        const std::int32_t column = model.surface(t, j);
        if (column >= model.free) continue;
        Mat3 share = drag;
        if (by_volume) {
          // The area vector's derivative by one corner is half the cross product with the edge opposite to it.
          const Vec3 edge = middle(x, model.surface(t, (j + 2) % 3)) - middle(x, model.surface(t, (j + 1) % 3));
          share += scheme_.theta * slope / 6 * cross_by(edge);
        }
        for (int i = 0; i < 3; ++i) {
          const std::int32_t row = model.surface(t, i);
          if (row < model.free && row >= column) hessian.add(row, column, share);
        }
      }
    }
  }
}

double AirForces::rank_one_share(const Model& model, int amount, const Positions& x, Positions& u) const {
  const ActivePart& part = parts_[fixed_[std::size_t(amount)]];
  const Part& of = model.parts[part.part];
  u.setZero(model.free, 3);
  for (Eigen::Index t = of.first_triangle; t < of.first_triangle + of.triangles; ++t) {
    const Vec3 third = part.sign / 3 * area_vector(model, t, x);
    for (const std::int32_t v : model.surface.row(t)) {
      if (v < model.free) u.row(v) += third.transpose();
    }
  }
  return scheme_.theta * part.law.stiffness(volume(model, part, x));
}

// A triangle that moves freely with the mass of its area keeps the share 1 / (1 + k h |w|) of its velocity w beyond the
// wind's, which solves dw/dt = -k |w| w over h exactly. Its mass is taken from the corner that is lightest for its
// area.
void AirForces::add_free_way(const Model& model, Positions& y) const {
  std::vector<double> areas(std::size_t(model.free), 0.0);
  for (const ActivePart& part : parts_) {
    if (!part.drags) continue;
    const Part& of = model.parts[part.part];
    const Eigen::Index end = of.first_triangle + of.triangles;
    const auto for_each_free_corner = [&](Eigen::Index t, const auto& visit) {
      for (const std::int32_t v : model.surface.row(t)) {
        if (v < model.free) visit(std::size_t(v));
      }
    };
    for (Eigen::Index t = of.first_triangle; t < end; ++t)
      for_each_free_corner(t, [&](std::size_t v) { areas[v] += facets_[std::size_t(t)].area / 3; });
    const Positions moved = y;
    for (Eigen::Index t = of.first_triangle; t < end; ++t) {
      const Facet& facet = facets_[std::size_t(t)];
      if (facet.area == 0) continue;
      double by_area = infinity;  // mass [kg/m^2]
      for_each_free_corner(t, [&](std::size_t v) { by_area = std::min(by_area, model.mass[v] / areas[v]); });
      const Vec3 beyond = beyond_wind(model, t, moved);
      const double across = facet.normal.dot(beyond);
      const Vec3 along = beyond - across * facet.normal;
      const auto kept = [&](double coefficient, double speed) { return 1 / (1 + coefficient * h_ * speed / by_area); };
      const Vec3 lost = (1 - kept(part.across, std::abs(across))) * across * facet.normal +
                        (1 - kept(part.along, along.norm())) * along;
      for_each_free_corner(t, [&](std::size_t v) {
        y.row(Eigen::Index(v)) -= (h_ * by_area * facet.area / (3 * model.mass[v]) * lost).transpose();
      });
    }
  }
}

}  // namespace supple
