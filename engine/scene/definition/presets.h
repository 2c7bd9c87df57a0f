// Provides materials under everyday names, so that a first scene works without parameters. Units are real, and the
// materials are soft enough for thirty steps per second.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "sim/elements/tetrahedron.h"
#include "sim/materials/material.h"

namespace supple {

struct MaterialPreset {
  const char* name;
  const char* meaning;
  double young, poisson;  // [Pa]
  double density;         // of bodies that do not give one [kg/m^3]
  double fibre;           // kappa along the body's y axis; 0: none [Pa]
  Material (*law)(const Lame&);

  Material material() const { return law(Lame::from_young(young, poisson)); }
};

template <class M>
Material law_of(const Lame& lame) {
  return M::from(lame);
}

// The moduli have the order that tables of engineering materials give for table jelly, a soft silicone rubber, muscle
// at rest and balsa (whose true fibre modulus is ten times higher; ten iterations per step would not resolve it).
// Poisson's ratio stays in the range where linear tetrahedra do not lock.
inline constexpr std::array material_presets = {
    MaterialPreset{"jelly", "table jelly: wobbles under its own weight", 1e4, 0.4, 1050, 0, law_of<NeoHookean>},
    MaterialPreset{"rubber", "soft rubber: springy, keeps its shape", 1e6, 0.45, 1100, 0, law_of<NeoHookean>},
    MaterialPreset{"flesh", "muscle at rest", 4e4, 0.45, 1060, 0, law_of<NeoHookean>},
    MaterialPreset{"wood", "balsa-like: stiff along the body's y axis, softer across", 2e7, 0.3, 160, 2e8,
                   law_of<Corotated>},
};

}  // namespace supple
