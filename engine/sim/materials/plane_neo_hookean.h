// This is a Neo-Hookean sheet under plane stress that is defined for every F, in the manner of stable Neo-Hookean
// flesh (Smith, de Goes, Kim 2018):
//   Psi = mu/2 (s1 - s2)^2 + (lambda + mu)/2 (J - 1)^2,   J = s1 s2,
// where lambda is that of plane stress. mu/2 (s1 - s2)^2 is mu/2 (I_C - 2) - mu (J - 1), so that small strains are
// those of Hooke's law. How a sheet gives way to compression is in tension_field.h.
#pragma once

#include <string_view>

#include "sim/materials/plane_lame.h"
#include "sim/materials/tension_field.h"

namespace supple {

struct PlaneNeoHookean {
  static constexpr std::string_view name = "neo-hookean";
  static constexpr bool isotropic = true;
  double mu = 0;
  double lambda = 0;
  double compression = 1;

  static PlaneNeoHookean from(const PlaneLame& lame, double compression) { return {lame.mu, lame.lambda, compression}; }

  // Computes the energy by area and its derivatives without regard to compression [N/m].
  template <class V>
  V taut(const V& s0, const V& s1, V (&slope)[2]) const {
    const V bulk(lambda + mu), apart = s0 - s1, excess = madd(s0, s1, V(-1.0));
    slope[0] = madd(V(mu), apart, bulk * excess * s1);
    slope[1] = madd(V(-mu), apart, bulk * excess * s0);
    return V(0.5) * madd(V(mu) * apart, apart, bulk * excess * excess);
  }

  // Returns the smaller stretch at which a strip with the larger one carries no tension across.
  template <class V>
  V natural_width(const V& s0) const {
    return V(lambda + 2 * mu) * s0 / madd(V(lambda + mu) * s0, s0, V(mu));
  }

  template <class V>
  V density(const V (&s)[2], V (&slope)[2]) const {
    return with_tension_field(*this, s, slope);
  }

  // Returns k of equation 11: the tension at the stretches s and 1 is (2 mu + lambda) (s - 1), a line [N/m].
  double fitted_stiffness(double, double) const { return 2 * mu + lambda; }
};

}  // namespace supple
