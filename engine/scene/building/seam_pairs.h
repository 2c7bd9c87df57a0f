// Finds the places on the border of a cloth that its seams join. Both sides of a seam are matched by their length along
// the border: each vertex of the side with more vertices is joined with the place at the same share of the other side's
// length. Not here: the force that draws these places together (sim/model/seams.h).
#pragma once

#include <string>
#include <vector>

#include "scene/building/body.h"

namespace supple {

// Adds to a body that is in its place the seams of its definition, and a note on them. Reports what is wrong with the
// points of a seam.
void add_seams(Body& body, std::vector<Problem>& problems);

// Says that the sides of a seam differ in length by more than a tenth; empty where they do not. number: the index of
// the seam in Body::seams.
std::string uneven_seam_text(const Body& body, std::size_t number);

}  // namespace supple
