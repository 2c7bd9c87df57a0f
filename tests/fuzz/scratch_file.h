// Inputs of fuzz targets as files, for readers that take a path.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

namespace supple::fuzz {

inline const std::filesystem::path assets = std::filesystem::path(SUPPLE_SOURCE_FOLDER) / "assets";

// Writes the bytes to a file in memory, whose path stays the same for the life of the process.
inline std::filesystem::path scratch_file(const std::uint8_t* data, std::size_t size, const std::string& more = "") {
  static const std::filesystem::path path =
      std::filesystem::path("/dev/shm") / ("supple-fuzz-" + std::to_string(::getpid()) + ".toml");
  std::FILE* file = std::fopen(path.c_str(), "wb");
  std::fwrite(data, 1, size, file);
  std::fwrite(more.data(), 1, more.size(), file);
  std::fclose(file);
  return path;
}

}  // namespace supple::fuzz
