// Describes a point at which the solver evaluates the objective, with all that is known of it.
#pragma once

#include <vector>

#include "base/aligned.h"
#include "base/types.h"
#include "sim/contact/contact.h"

namespace supple {

struct Iterate {
  Positions x;                   // positions, n x 3 [m]
  Positions gradient;            // of g, n_free x 3 [N]
  AlignedVector<double> energy;  // of the elements, by lane [J]
  Positions bending_forces;      // forces of bending, n_free x 3 [N]; empty without bending
  // Energies of RestCurvature, by triangle [J]; empty without cloth that is curved at rest.
  std::vector<double> curvature_energy;
  std::vector<Contact> contacts;  // found at x, or so near it that they were kept; empty where nothing may touch
  double moved = 0;               // no vertex has moved further since the contacts were found [m]
  bool keeps_contacts = false;    // whether this trial iterate is to take over the contacts that the current one holds
  double g = 0;                   // the objective at x, with these contacts [J]
  double elastic = 0;             // the share in g of the elements [J]; not finite: not known
};

}  // namespace supple
