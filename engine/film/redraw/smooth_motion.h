// Interpolates saved motion between two frames, for slow motion.
#pragma once

#include <array>

#include "base/types.h"

namespace supple {

// Returns positions between the second and the third of four frames that follow each other, n x 3 [m]. share: of the
// way between the two. Each vertex goes along a cubic curve (Hermite's) through its places; its velocity at a frame is
// the mean of those before and after (Catmull and Rom 1974), but at most three times the slower one (Fritsch and
// Carlson 1980): what comes to rest on the ground does not swing through it.
Positions between_frames(const std::array<Positions, 4>& frames, double share);

}  // namespace supple
