// Finds the file or folder that a mistyped path may mean.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace supple {

// Returns the entry of the path's folder whose name without its ending is nearest to the path's; empty where none is
// near. fits: a function that tells which entries count. names: further words, without a folder, that count as well. Of
// equally near ones, an entry is taken where the missing path has a folder, and else a name.
std::filesystem::path near_file(const std::filesystem::path& missing,
                                const std::function<bool(const std::filesystem::path&)>& fits,
                                const std::vector<std::string>& names = {});

// Returns "; did you mean 'out/squirrel'?"; nothing for an empty path.
std::string meant_file(const std::filesystem::path& file);

}  // namespace supple
