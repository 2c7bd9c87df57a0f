// Guesses which axis of a model's file points up, for a first film of the model: by the kind of file, by the model's
// proportions, and by how it would stand.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/meshes/mesh.h"
#include "geometry/solids/solid_surface.h"

namespace supple {

struct Upright {
  UpAxis up;
  std::string reason;  // why, in words; empty where y is up, as in most files
};

// Returns the axis on which a closed surface most likely stands.
Upright guess_upright(const std::filesystem::path& file, const TriMesh& surface);

// Returns how far the centre of mass of a solid lies within the hull of what it stands on when this axis points up,
// over its mean width; negative where it would topple. sole: what is as low as this share of the height stands on the
// ground.
double steadiness(const TriMesh& surface, UpAxis up, double sole = 0.03);

// Returns the least share of the height, y up, such that the solid is steady on all that is as low, and the largest
// that is tried where it is steady on none.
double steady_sole(const TriMesh& surface);

}  // namespace supple
