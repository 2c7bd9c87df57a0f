// Computes the passes of a picture (base/picture_pass.h) from what the visibility buffer shows, without GL. A pixel has
// the values of one point, so that they are never mixed between two surfaces: of the surface that most of its samples
// show, at the mean place of these samples. That is the middle of a pixel which shows nothing else. Masks alone are
// shares of a pixel. Ghosts are in no pass.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/picture_pass.h"
#include "render/draw_list.h"
#include "render/visibility.h"

namespace supple {

// The depth of pixels that show nothing [m]. Infinity would become NaN in filters of other programs.
constexpr float no_depth = 1e10F;

struct PassImage {
  PicturePass pass;
  std::string mesh;           // the name of the mesh whose mask it is; empty for other passes
  int channels = 1;           // 1, or 3
  std::vector<float> values;  // rows from the top
};

// Holds what passes are made of. All of it must outlive the call.
struct PassSource {
  const std::vector<DrawMesh>& meshes;
  const DrawList& list;
  const DrawList* next;  // of the next picture; null where there is none, so that nothing moves
  const Visibility& visibility;
  int width, height;
  bool ground;  // whether y = 0 is seen, or catches shadows
};

// Returns the passes that are asked for: one picture each, and of masks one for each name of a mesh.
std::vector<PassImage> passes_of(const PassSource& source, std::span<const PicturePass> asked);

}  // namespace supple
