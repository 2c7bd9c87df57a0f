// Defines the order of the contacts of one body in a list: by what is touched, then by number of the point.
#pragma once

#include "sim/contact/contact.h"

namespace supple {

inline bool comes_before(const Contact& a, const Contact& b) {
  return a.other != b.other ? a.other < b.other : a.number < b.number;
}

}  // namespace supple
