// This is a St. Venant-Kirchhoff sheet under plane stress:
//   Psi = mu (E1^2 + E2^2) + lambda/2 (E1 + E2)^2,   E = (s^2 - 1)/2,
// where lambda is that of plane stress. How a sheet gives way to compression is in tension_field.h; without that, an
// area that is compressed below 1/sqrt(3) of its width loses its stiffness, as solids of this material do.
#pragma once

#include <string_view>

#include "sim/materials/plane_lame.h"
#include "sim/materials/tension_field.h"

namespace supple {

struct PlaneStVenantKirchhoff {
  static constexpr std::string_view name = "st-venant-kirchhoff";
  static constexpr bool isotropic = true;
  double mu = 0;
  double lambda = 0;
  double compression = 1;

  static PlaneStVenantKirchhoff from(const PlaneLame& lame, double compression) {
    return {lame.mu, lame.lambda, compression};
  }

  // Computes the energy by area and its derivatives without regard to compression [N/m].
  template <class V>
  V taut(const V& s0, const V& s1, V (&slope)[2]) const {
    const V half(0.5), one(1.0);
    const V e0 = half * (s0 + one) * (s0 - one), e1 = half * (s1 + one) * (s1 - one), trace = e0 + e1;
    slope[0] = s0 * madd(V(2 * mu), e0, V(lambda) * trace);
    slope[1] = s1 * madd(V(2 * mu), e1, V(lambda) * trace);
    return madd(V(mu), madd(e0, e0, e1 * e1), V(0.5 * lambda) * trace * trace);
  }

  // Returns the smaller stretch at which a strip with the larger one carries no tension across: E2 = -nu E1 with
  // Poisson's ratio nu = lambda / (2 mu + lambda).
  template <class V>
  V natural_width(const V& s0) const {
    using std::max;
    using std::sqrt;
    const V one(1.0);
    return sqrt(max(V(1e-12), madd(V(-lambda / (2 * mu + lambda)), (s0 + one) * (s0 - one), one)));
  }

  template <class V>
  V density(const V (&s)[2], V (&slope)[2]) const {
    return with_tension_field(*this, s, slope);
  }

  // Returns k of equation 11 for the tension (mu + lambda/2) (s^3 - s) at the stretches s and 1 [N/m].
  double fitted_stiffness(double start, double end) const {
    const auto moment = [](double s) { return s * s * (0.5 + s * (-1.0 / 3 + s * (-0.25 + s * 0.2))); };
    const auto cube = [](double s) { return (s - 1) * (s - 1) * (s - 1) / 3; };
    return (mu + 0.5 * lambda) * (moment(end) - moment(start)) / (cube(end) - cube(start));
  }
};

}  // namespace supple
