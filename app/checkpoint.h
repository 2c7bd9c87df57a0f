// A film after some of its frames: what it takes to go on as if it had never stopped.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/assemble.h"

namespace supple {

// All of a body that its next step depends on and that no file says.
struct BodyMoment {
  State state;
  Anchors anchors;
  std::vector<char> holds;  // by handle
};

struct Checkpoint {
  int frames = 0;  // finished
  std::vector<BodyMoment> bodies;
};

// As a file's content. identity: JSON of all that must be the same for the film to go on.
std::string checkpoint_bytes(const Checkpoint& checkpoint, const std::string& identity);

// Throws InputError: no such file, damaged, or of another identity, with the differences named.
Checkpoint read_checkpoint(const std::filesystem::path& path, const std::string& identity);

}  // namespace supple
