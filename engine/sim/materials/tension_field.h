// Makes a sheet give way to compression. A thin sheet does not carry compression: it wrinkles, more finely than the
// triangles of a mesh can show. Its relaxed energy (Pipkin 1986, "The relaxed energy density for isotropic elastic
// membranes") has no stress across a wrinkled strip, which is as if the strip had its natural width, and none at all
// where both directions are compressed. A sheet has the share c = `compression` of the plain energy, and 1 - c of the
// relaxed one.
#pragma once

#include "sim/materials/small_matrix.h"

namespace supple {

// Returns the energy by area at the stretches s[0] >= s[1] and sets its derivatives [N/m]. M must have taut(s0, s1,
// slope), natural_width(s0) and compression.
template <class M, class V>
V with_tension_field(const M& sheet, const V (&s)[2], V (&slope)[2]) {
  const V plain = sheet.taut(s[0], s[1], slope);
  if (sheet.compression >= 1) return plain;
  const V one(1.0), zero(0.0), share(sheet.compression), rest(1 - sheet.compression);
  const V width = sheet.natural_width(s[0]);
  const auto is_slack = s[0] < one, is_wrinkled = s[1] < width;
  V along[2];
  const V wrinkled = sheet.taut(s[0], width, along);
  const V energy = choose(is_slack, zero, choose(is_wrinkled, wrinkled, plain));
  slope[0] = madd(share, slope[0], rest * choose(is_slack, zero, choose(is_wrinkled, along[0], slope[0])));
  slope[1] = madd(share, slope[1], rest * choose(is_slack, zero, choose(is_wrinkled, zero, slope[1])));
  return madd(share, plain, rest * energy);
}

}  // namespace supple
