// Computes the energy of gas in a volume V and its derivatives. With an open amount the pressure above the atmosphere's
// is constant, p, and the energy is -p (V - V0). A fixed amount at constant temperature (Boyle's law) keeps p V = p0 V0
// with p absolute, and has the energy -p0 V0 log(V / V0) + p_atm (V - V0), where the second term is the work on the
// atmosphere outside. Below a twentieth of V0 this energy continues as its second-order Taylor polynomial, which is
// finite for volumes that are turned inside out. Not here: the volume of a surface (air_forces.h).
#pragma once

#include "sim/model/air_inputs.h"

namespace supple {

class GasLaw {
 public:
  // rest_volume: V0 [m^3], above 0.
  GasLaw(const GasFilling& filling, double rest_volume);

  double energy(double volume) const;          // 0 at V0 [J]
  double gauge_pressure(double volume) const;  // minus the derivative of the energy [Pa]
  double stiffness(double volume) const;       // the second derivative of the energy [J/m^6]
  // Returns energy(volume + change) - energy(volume) with the digits of the change [J].
  double energy_change(double volume, double change) const;

 private:
  double filled_;        // p0 V0, absolute; 0: an open amount [J]
  double gauge_;         // of an open amount [Pa]
  double rest_, least_;  // V0, and the volume below which the energy continues as a polynomial [m^3]
};

}  // namespace supple
