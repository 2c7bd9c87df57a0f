// Compares what the header of a surface file announces with the size of the file. Readers take memory for what is
// announced before they find that it is not there, and some never return where the header has no end.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace supple {

// Returns what is wrong with a PLY or OFF file that begins with `begin` and has `bytes` bytes; empty where nothing is,
// and for files of other formats.
std::string announced_too_much(std::string_view begin, std::uintmax_t bytes);

// The largest header that is looked at [bytes].
inline constexpr std::size_t most_header_bytes = 1 << 16;

}  // namespace supple
