// Names the passes of a film: what pictures for a compositor tell of each pixel, in numbers, beside its colour.
#pragma once

#include "base/names.h"

namespace supple {

enum class PicturePass {
  depth,      // distance along the viewing direction [m]
  normals,    // unit normal of the surface, in the world
  masks,      // share of the pixel that each body covers, one picture a body
  motion,     // way to the place in the next picture, to the right and up [pixels]
  positions,  // place in the world [m]
};
template <>
struct Names<PicturePass> {
  static constexpr std::array table = {Name{PicturePass::depth, "depth"}, Name{PicturePass::normals, "normals"},
                                       Name{PicturePass::masks, "masks"}, Name{PicturePass::motion, "motion"},
                                       Name{PicturePass::positions, "positions"}};
};

}  // namespace supple
