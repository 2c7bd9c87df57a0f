// Defines the order of contacts in a list: by what is touched, other parts before colliders, then by number of the
// point.
#pragma once

#include "sim/contact/contact.h"

namespace supple {

inline bool comes_before(const Contact& a, const Contact& b) {
  return a.other != b.other ? a.other < b.other : a.number < b.number;
}

}  // namespace supple
