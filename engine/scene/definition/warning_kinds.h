// Names the kinds of warnings about a body, by which a body can say that one of them is meant.
#pragma once

#include <array>

#include "base/names.h"

namespace supple {

enum class WarningKind {
  slivers,    // flat elements
  handle,     // it jumps when it grabs, or is soft for its load
  turning,    // one level keeps the body from turning
  stiffness,  // more than the iterations solve
  inside,     // the body starts inside a collider
  fall,       // through the ground that the film shows
  material,   // without force, or softening, where the body is
  weight,     // strains the body
  size,       // small for its steps
  regions,    // of stiffnesses that are far apart
  thin,       // a bar or a plate with few elements across
  delay,      // of chebyshev, which leaves no iteration
  overlap,    // of two bodies
  skin,       // reaches far beyond the elements
  unsolved,   // steps, known at the end of a film
};
template <>
struct Names<WarningKind> {
  static constexpr std::array table = {
      Name{WarningKind::slivers, "slivers"},   Name{WarningKind::handle, "handle"},
      Name{WarningKind::turning, "turning"},   Name{WarningKind::stiffness, "stiffness"},
      Name{WarningKind::inside, "inside"},     Name{WarningKind::fall, "fall"},
      Name{WarningKind::material, "material"}, Name{WarningKind::weight, "weight"},
      Name{WarningKind::size, "size"},         Name{WarningKind::regions, "regions"},
      Name{WarningKind::thin, "thin"},         Name{WarningKind::delay, "delay"},
      Name{WarningKind::overlap, "overlap"},   Name{WarningKind::skin, "skin"},
      Name{WarningKind::unsolved, "unsolved"}};
};

}  // namespace supple
