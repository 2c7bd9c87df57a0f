// Checks what a film's files can hold of what its scene shows.
#pragma once

#include "output/video/video.h"

namespace supple {

struct SceneDef;

// Returns how the film of a scene is encoded: with coverage where its pictures have it. Throws InputError where the
// format that is asked for holds none.
FilmCoding coding_for(const FilmCoding& asked, const SceneDef& scene);

// Refuses passes where the program was built without the library that writes them. Throws InputError.
void check_passes(const SceneDef& scene);

}  // namespace supple
