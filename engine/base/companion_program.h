// Finds the programs that belong to the one that runs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace supple {

// Looks beside the running program, where a build leaves it, and in the folder that an installation has for programs
// that users do not call themselves. Returns nothing where it is in neither.
std::optional<std::filesystem::path> companion_program(const std::string& name);

}  // namespace supple
