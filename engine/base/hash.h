// XXH64 over bytes identifies states and files. Doubles are hashed as little-endian bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace supple {

std::uint64_t hash_bytes(const void* bytes, std::size_t count, std::uint64_t seed = 0);
inline std::uint64_t hash_text(std::string_view text) { return hash_bytes(text.data(), text.size()); }

// Writes the hash as sixteen hexadecimal digits.
std::string hash_text_form(std::uint64_t hash);

// Returns the XXH64 of the running program's file, which differs from build to build.
std::uint64_t program_identity();

}  // namespace supple
