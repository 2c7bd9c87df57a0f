// Writes the skins that a film shows, with their motion, for other programs: for each body, an OBJ file with the skin
// at rest and a PC2 point cache, like those that motion/ has for the simulated mesh. Nothing is simulated.
#pragma once

#include <filesystem>
#include <functional>

#include "film/redraw/redraw.h"

namespace supple {

// Creates the folder of the skins, or takes over one that earlier skins left. Throws InputError when it holds anything
// else, and RunError when the disk refuses.
void open_skins(const std::filesystem::path& folder, const LoadedDrawing& drawing);

// Writes motion/BODY.obj and motion/BODY.pc2 of all bodies, at full resolution, with a sample for each chosen frame.
// told: called after each frame with the number of frames done. Returns the number of frames done, which is smaller
// than that of the chosen frames when the user interrupts.
int write_skins(LoadedDrawing& drawing, const std::filesystem::path& folder, const std::function<void(int)>& told);

}  // namespace supple
