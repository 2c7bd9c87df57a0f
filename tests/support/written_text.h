// Writes text files for tests.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace supple::test {

// Writes a file, and makes its folder where there is none.
inline void write_text(const std::filesystem::path& path, const std::string& text) {
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace supple::test
