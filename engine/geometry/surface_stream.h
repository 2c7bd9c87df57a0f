// Defines what supple-read-surface writes: either `refused` and a reason of one line, or `accepted`, two counts
// (int64), the positions (3 doubles a vertex) and the indices (3 int32 a triangle), all with the bytes that they have
// in memory.
#pragma once

#include <cstdint>

namespace supple::surface_stream {

inline constexpr char accepted[8] = {'s', 'u', 'r', 'f', 'a', 'c', 'e', '1'};
inline constexpr char refused[8] = {'r', 'e', 'f', 'u', 's', 'e', 'd', ':'};
inline constexpr std::int64_t most_triangles = 5'000'000;
inline constexpr std::int64_t most_vertices = 3 * most_triangles;  // reached when no vertex is shared

}  // namespace supple::surface_stream
