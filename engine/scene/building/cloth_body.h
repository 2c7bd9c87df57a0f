// Makes the bodies of cloth before they are placed: grids, and the triangles of files with what these say of them.
// Not here: which shape they have at rest in the world, and what they weigh (weaving.h).
#pragma once

#include <filesystem>

#include "scene/building/body.h"

namespace supple {

// Returns the body of a cloth in the frame of its file or grid. Throws InputError.
Body body_of_cloth(const BodyDef& def);

// Chooses between the colours of a body's file (Body::file_colors) and its own, and names what is drawn as a source.
void choose_colors(const BodyDef& def, const std::filesystem::path& file, Body& body);

}  // namespace supple
