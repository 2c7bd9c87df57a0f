// Keeps the state of a film's world in a file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "world/world_state.h"

namespace supple {

// Returns the content of a checkpoint's file. identity: JSON of all that must be the same for the film to be resumed.
std::string checkpoint_bytes(const WorldState& checkpoint, const std::string& identity);

// Reads a checkpoint. Throws InputError when there is no such file, when it is damaged, or when it has another
// identity, whose differences the message then lists.
WorldState read_checkpoint(const std::filesystem::path& path, const std::string& identity);

// Does the same for those who make no film of it: what files the film leaves, and how they are drawn, may differ.
WorldState read_motion_checkpoint(const std::filesystem::path& path, const std::string& identity);

}  // namespace supple
