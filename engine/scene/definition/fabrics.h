// Provides fabrics under everyday names. Densities and bending are measured (the sources stand at the rows); one number
// stands for bending along warp and weft. Stretch and, mostly, shear are lower than in such fabrics, which have some
// 1e4 N/m and 30 to 100 N/m (Fan, Yu, Hunter 2004, "Clothing appearance and fit", chapter 1): a metre of cloth still
// stretches by a few thousandths under its weight, which is not seen, and ten iterations at thirty steps a second solve
// its motion, which they do not at the whole stiffness.
#pragma once

#include <array>

#include "sim/materials/membrane.h"

namespace supple {

struct FabricPreset {
  const char* name;
  const char* meaning;
  double warp, weft, shear;  // [N/m]
  double bending;            // [N m]
  double density;            // of bodies that do not give one [kg/m^2]
  double limit;              // stretch at which the threads lock

  Fabric fabric() const { return {Woven{warp, weft, shear, 0.05, limit}, bending}; }
};

// Cotton is the broadcloth A of Matsudaira, Masuda, Wada, Yokura 2015, "Shape factor of flared skirts compared with
// that of circular fabrics", table 1. Denim and jersey have density and bending of `11oz-black-denim` and of the limp
// ones of Wang, O'Brien, Ramamoorthi 2011, "Data-driven elastic models for cloth" and Feng, Huang, Xu, Wang 2022,
// "Learning-based bending stiffness parameter estimation by a drape tester"; silk is of the lightest class of the
// latter.
inline constexpr std::array fabric_presets = {
    FabricPreset{"cotton", "plain-woven shirting", 1200, 900, 15, 1.2e-5, 0.124, 1.1},
    FabricPreset{"denim", "stiff twill, such as of jeans", 3000, 2000, 40, 8e-5, 0.324, 1.1},
    FabricPreset{"silk", "light habotai: flows, and floats in a wind", 350, 250, 3, 1.1e-6, 0.035, 1.1},
    FabricPreset{"jersey", "single knit, such as of T-shirts: stretches", 300, 150, 20, 2e-6, 0.187, 1.6},
    FabricPreset{"felt", "thick pressed wool: keeps its shape", 1500, 1500, 400, 2e-4, 0.3, 1.1},
};

}  // namespace supple
