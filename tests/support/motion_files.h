// Writes motions of surfaces for tests: PC2 and MDD point caches.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple::test {

// Appends four bytes, the lowest first or last.
inline void append_word(std::string& bytes, std::uint32_t value, bool lowest_first) {
  for (int i = 0; i < 4; ++i) bytes += char(value >> 8 * (lowest_first ? i : 3 - i) & 255);
}
inline void append_frame(std::string& bytes, const Positions& points, bool lowest_first) {
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    for (int k = 0; k < 3; ++k) append_word(bytes, std::bit_cast<std::uint32_t>(float(points(v, k))), lowest_first);
}

inline std::string pc2_bytes(const std::vector<Positions>& frames) {
  std::string bytes("POINTCACHE2\0", 12);
  for (const std::uint32_t word : {std::uint32_t(1), std::uint32_t(frames.front().rows()), std::uint32_t(0),
                                   std::bit_cast<std::uint32_t>(1.0f), std::uint32_t(frames.size())})
    append_word(bytes, word, true);
  for (const Positions& frame : frames) append_frame(bytes, frame, true);
  return bytes;
}

inline std::string mdd_bytes(const std::vector<Positions>& frames, bool lowest_first = false) {
  std::string bytes;
  append_word(bytes, std::uint32_t(frames.size()), lowest_first);
  append_word(bytes, std::uint32_t(frames.front().rows()), lowest_first);
  for (std::size_t f = 0; f < frames.size(); ++f)
    append_word(bytes, std::bit_cast<std::uint32_t>(float(f) / 30), lowest_first);
  for (const Positions& frame : frames) append_frame(bytes, frame, lowest_first);
  return bytes;
}

}  // namespace supple::test
