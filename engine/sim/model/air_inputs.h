// Defines what the air around bodies, and gas in them, is: the wind, the coefficients of drag, the filling of a closed
// surface. They are part of a step's inputs (inputs.h) and may change from step to step. Not here: the forces that
// follow from them (sim/air/).
#pragma once

#include <cstdint>
#include <optional>

#include "base/names.h"
#include "base/types.h"

namespace supple {

// Describes the air that moves past the bodies (sim/air/wind_field.h).
struct Wind {
  Vec3 velocity = Vec3(0, 0, 0);  // mean velocity [m/s]
  double gusts = 0;               // root mean square of the gusts' speed, over the mean speed
  double gust_length = 3;         // length of the largest gusts [m]
  double gust_period = 2;         // time in which the largest gusts pass [s]
  double density = 1.2;           // of the air [kg/m^3]
  std::uint64_t seed = 1;         // of the gusts' phases
};

// Holds the coefficients of the force that air has on a surface, for flow across it and along it. A flat plate of area
// A across a wind of speed v gets the force normal * density * A v^2 / 2.
struct DragCoefficients {
  double normal = 0;
  double tangent = 0;

  bool act() const { return normal > 0 || tangent > 0; }
};

// A square or round plate across the wind has 1.17 (Hoerner 1965, "Fluid-dynamic drag", chapter 3). Friction along both
// sides of a sheet of cloth is small beside that.
inline constexpr DragCoefficients usual_drag{1.17, 0.02};

enum class GasAmount {
  open,   // gas flows in and out, so that the pressure stays
  fixed,  // no gas enters or leaves: pressure times volume stays
};
template <>
struct Names<GasAmount> {
  static constexpr std::array table = {Name{GasAmount::open, "open"}, Name{GasAmount::fixed, "fixed"}};
};

inline constexpr double atmospheric_pressure = 101325;  // the standard atmosphere [Pa]

// Describes the gas that a closed surface holds.
struct GasFilling {
  double gauge = 0;  // pressure above the atmosphere's; of a fixed amount: at the volume of the rest shape [Pa]
  GasAmount amount = GasAmount::open;
};

// Says what air has to do with one part of a model.
struct PartAir {
  DragCoefficients drag;          // of its surface
  std::optional<GasFilling> gas;  // in its surface, which must then be closed; nothing: there is none
};

}  // namespace supple
