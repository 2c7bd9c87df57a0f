// Reads files that come from outside. Only regular files are read, up to a size that the caller states: a device or a
// pipe may have no end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace supple {

inline constexpr std::uintmax_t usual_most_bytes = 1'000'000'000;

// Returns the file's content. Throws InputError that names the file and says what is wrong: there is no such file, it
// is not a regular file, it is larger than `most_bytes`, or it cannot be read, with the system's reason.
std::string read_file(const std::filesystem::path& path, std::uintmax_t most_bytes = usual_most_bytes);

// Returns the content of a text file without the byte-order mark of UTF-8 that some editors put before it. Throws
// InputError as read_file() does, and for texts of 16-bit characters, which have a mark of their own.
std::string read_text(const std::filesystem::path& path, std::uintmax_t most_bytes = usual_most_bytes);

// Returns all of standard input. Throws InputError that names `<stdin>` when it is larger than `most_bytes` or cannot
// be read.
std::string read_standard_input(std::uintmax_t most_bytes);

// Throws InputError as read_file() does when the path does not name a regular file.
void check_regular_file(const std::filesystem::path& path);

}  // namespace supple
