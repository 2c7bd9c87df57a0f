// Shows the contacts of a joined model as one of its parts feels them.
#pragma once

#include <vector>

#include "sim/contact/contact.h"
#include "sim/model/model.h"

namespace supple {

// Returns the contacts that act on a part. A contact between two parts acts on both, and so is among those of either.
// Vertices have the numbers of the part's own model, and parts (OtherSide::part) those of the joined one. All that
// belongs to other parts is kept where it is at x: their vertices only move the plane and the origin of friction. At x,
// the energies and the forces on the part are those of the joined contacts.
std::vector<Contact> contacts_of_part(const Model& joined, const Part& part, const std::vector<Contact>& contacts,
                                      const Positions& x);

}  // namespace supple
