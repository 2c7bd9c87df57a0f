// Cuts a triangle at middles of its edges, so that triangles on both sides of an edge fit each other.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace supple {

// Holds the numbers of a triangle's three vertices.
using CornerNumbers = std::array<std::int32_t, 3>;

// Appends the parts of a triangle: the triangle itself where no edge is cut. middle: the vertex in the middle of the
// edge from corner k to the next; -1: the edge stays whole. Where two edges are cut, the shorter diagonal is taken.
// length2: returns the squared distance of two vertices.
template <class Length2>
void split_triangle(const CornerNumbers& corners, const std::array<std::int32_t, 3>& middle, const Length2& length2,
                    std::vector<CornerNumbers>& parts) {
  int halved = 0;
  for (const std::int32_t one : middle) halved += one >= 0 ? 1 : 0;
  if (halved == 0) {
    parts.push_back(corners);
    return;
  }
  if (halved == 3) {
    for (std::size_t k = 0; k < 3; ++k) parts.push_back({corners[k], middle[k], middle[(k + 2) % 3]});
    parts.push_back({middle[0], middle[1], middle[2]});
    return;
  }
  // Corners are named so that the edge from a to b is halved, and of two halved edges the second is that from b to c.
  std::size_t first = middle[0] >= 0 ? 0 : (middle[1] >= 0 ? 1 : 2);
  if (halved == 2 && middle[(first + 1) % 3] < 0) first = (first + 2) % 3;
  const std::int32_t a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3], ab = middle[first],
                     bc = middle[(first + 1) % 3];
  if (halved == 1) {
    parts.insert(parts.end(), {{a, ab, c}, {ab, b, c}});
  } else if (length2(a, bc) <= length2(ab, c)) {
    parts.insert(parts.end(), {{ab, b, bc}, {a, ab, bc}, {a, bc, c}});
  } else {
    parts.insert(parts.end(), {{ab, b, bc}, {a, ab, c}, {ab, bc, c}});
  }
}

}  // namespace supple
