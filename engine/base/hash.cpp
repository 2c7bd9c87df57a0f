#include "base/hash.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <bit>

namespace supple {

static_assert(std::endian::native == std::endian::little, "state hashes are defined over little-endian doubles");

std::uint64_t hash_bytes(const void* bytes, std::size_t count, std::uint64_t seed) { return XXH64(bytes, count, seed); }

std::string hash_text_form(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

}  // namespace supple
