// Names the kinds of warnings about a body, by which a body can say that one of them is meant.
#pragma once

#include <array>

#include "base/names.h"

namespace supple {

enum class WarningKind {
  slivers,    // the body has flat elements
  handle,     // a handle jumps when it grabs, is soft for its load, or follows a body that shakes
  turning,    // the solver, by one level or by damping, keeps the body from turning
  stiffness,  // the body is stiffer than the iterations can solve
  inside,     // the body starts inside a collider
  fall,       // the body falls through the ground that the film shows
  material,   // the material gives no force as the body starts, softens much, or is loose near rest
  weight,     // the body's weight strains it much
  size,       // the body is small for its steps
  regions,    // the stiffnesses of the body's regions are far apart
  thin,       // the body is a bar or a plate with few elements across
  delay,      // chebyshev's delay leaves no iteration to accelerate
  overlap,    // bodies, or parts of one, share a place (body_passings.h, body_depths.h; `inside`: starts_inside.h)
  skin,       // the skin reaches far beyond the elements
  cut,        // a cloth starts stretched far from the flat pieces that it was cut from
  seam,       // the sides of a seam have very different lengths
  unsolved,   // steps are left unsolved; known at the end of a film
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
      Name{WarningKind::cut, "cut"},           Name{WarningKind::seam, "seam"},
      Name{WarningKind::unsolved, "unsolved"}};
};

}  // namespace supple
