// Makes the bodies of cloth before they are placed: grids, and the triangles of files with what these say of them.
// Not here: which shape they have at rest in the world, and what they weigh (weaving.h).
#pragma once

#include <filesystem>

#include "scene/building/body.h"

namespace supple {

// Returns the body of a cloth in the frame of its file or grid. Throws InputError.
Body body_of_cloth(const BodyDef& def);

// Sets Body::colors to the colours of the body's file (Body::file_colors) where the definition wants them, and lists
// them in Body::files. Notes it where the file lacks colours that are asked for.
void choose_colors(const BodyDef& def, const std::filesystem::path& file, Body& body);

}  // namespace supple
