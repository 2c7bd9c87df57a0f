// Defines the order of contacts in a list: by what is touched, other parts before colliders, then by number of the
// point. An edge that touches edges of a solid has the number of its first vertex, once for each of them, and that
// vertex may have a contact itself.
#pragma once

#include "sim/contact/contact.h"

namespace supple {

inline bool comes_before(const Contact& a, const Contact& b) {
  return a.other != b.other ? a.other < b.other : a.number < b.number;
}

// Tells whether two contacts that are at one place of the order, and touch no cloth, are of the same point, or of the
// same two edges.
inline bool is_same_contact(const Contact& a, const Contact& b) {
  const bool between_edges = a.stencil.is_between_edges();
  return between_edges == b.stencil.is_between_edges() && (!between_edges || a.stencil.vertex == b.stencil.vertex);
}

}  // namespace supple
