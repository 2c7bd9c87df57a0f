// A film after some of its frames: all that it takes to continue as if it had never stopped.
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

// As a file's content. identity: JSON of all that must be the same for the film to be resumed.
std::string checkpoint_bytes(const Checkpoint& checkpoint, const std::string& identity);

// Throws InputError: there is no such file, it is damaged, or it has another identity, with the differences named.
Checkpoint read_checkpoint(const std::filesystem::path& path, const std::string& identity);

}  // namespace supple
