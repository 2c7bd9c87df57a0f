// Finds the program that runs, and those that belong to it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace supple {

// Returns the file of the running program, or of the shared object that has this code in another program; empty where
// the system does not tell.
std::filesystem::path this_program();

// Looks beside the running program, where a build leaves it, and in the folder that an installation has for programs
// that users do not call themselves. Returns nothing where it is in neither.
std::optional<std::filesystem::path> companion_program(const std::string& name);

}  // namespace supple
