#include "base/hash.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <bit>
#include <fstream>
#include <sstream>

namespace supple {

static_assert(std::endian::native == std::endian::little, "state hashes are defined over little-endian doubles");

std::uint64_t hash_bytes(const void* bytes, std::size_t count, std::uint64_t seed) { return XXH64(bytes, count, seed); }

std::string hash_text_form(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::uint64_t program_identity() {
  static const std::uint64_t identity = [] {
    std::ifstream file("/proc/self/exe", std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return hash_text(bytes.view());
  }();
  return identity;
}

}  // namespace supple
