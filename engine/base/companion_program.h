// Finds the file of the running program, and the programs that belong to it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace supple {

// Returns the file of the running program, or, where another program has this code in a shared object (.so), the file
// of that object. Empty where the system does not tell.
std::filesystem::path this_program();

// Returns the file of a program that belongs to the running one. It is looked for beside this_program(), where a build
// leaves it, and in the folder that an installation has for programs that users do not call themselves. Returns nothing
// where it is in neither.
std::optional<std::filesystem::path> companion_program(const std::string& name);

}  // namespace supple
