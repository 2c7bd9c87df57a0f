// Makes the drawn surfaces of bodies. They are made apart from the bodies, so that a run without images does not pay.
#pragma once

#include "base/slow_work.h"
#include "geometry/skins/embedding.h"
#include "geometry/skins/skin.h"
#include "geometry/skins/skin_limit.h"
#include "geometry/skins/surface_colors.h"
#include "geometry/skins/surface_weights.h"
#include "scene/building/assemble.h"

namespace supple {

// Holds the drawn surface of a body: a skin that its elements carry, or (vertex_of) the mesh's own boundary.
struct DrawnBody {
  Skin skin;
  Triangles casters;                    // the skin's triangles that cast its shadow; empty: all of them
  Embedding embedding;                  // how elements carry a skin that is not the boundary
  std::optional<SkinLimit> limit;       // limit of the skin's stretch, once limit_stretch() has been called
  std::vector<std::int32_t> vertex_of;  // for the mesh's boundary: mesh vertex by skin vertex, before it is subdivided
  bool subdivides = false;              // whether cameras subdivide the mesh's boundary, as for cloth
  SurfaceWeights weights;               // weights of the mesh's vertices in those of a boundary that is subdivided
  bool two_sided = false;
  Vec3 color;
  std::vector<PaintLayer> layers;  // colours only; their areas live in the skin
  Textures textures;               // of the skin's colours
};

// Chooses the surface by which bodies are drawn.
enum class DrawnAs {
  skin,      // the surface of the body's shape or surface file, where there is one
  elements,  // the boundary of its elements
};

// Makes what is drawn of each body. Bodies that are drawn alike share the work, and skins are kept from run to run.
std::vector<DrawnBody> drawn_bodies(const std::vector<Body>& bodies, const SlowWork& work = {},
                                    DrawnAs surface = DrawnAs::skin);

}  // namespace supple
