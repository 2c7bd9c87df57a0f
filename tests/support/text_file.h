// Writes a file for a test, and the folders that it lies in.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace supple::test {

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::error_code ignored;  // a file that cannot be written fails the test that reads it
  std::filesystem::create_directories(path.parent_path(), ignored);
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace supple::test
