// Holds a film after some of its frames: all that is needed to continue as if it had never stopped.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/model/state.h"

namespace supple {

struct Checkpoint {
  int frames = 0;  // finished
  std::vector<State> bodies;
};

// Returns the content of a checkpoint's file. identity: JSON of all that must be the same for the film to be resumed.
std::string checkpoint_bytes(const Checkpoint& checkpoint, const std::string& identity);

// Throws InputError when there is no such file, when it is damaged, or when it has another identity; the message then
// lists the differences.
Checkpoint read_checkpoint(const std::filesystem::path& path, const std::string& identity);

}  // namespace supple
