// Files that exist are whole: written under a temporary name beside their place, then renamed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace supple {

// Throws RunError naming the file and the system's reason; a temporary file is not left behind.
void write_whole_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
void write_whole_file(const std::filesystem::path& path, std::string_view text);

}  // namespace supple
