// Finds solid bodies that have too few elements across to bend as they should: bars, plates and shells of any mesh.
#pragma once

#include <string>

#include "scene/building/body.h"

namespace supple {

// Tells of a slender body that is one or two elements across; empty for all others, for cloth too. A thin part of a
// body that is compact otherwise, such as an ear, does not count.
std::string thinness_text(const Body& body);

}  // namespace supple
