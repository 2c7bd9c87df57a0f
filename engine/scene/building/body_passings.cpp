#include "scene/building/body_passings.h"

namespace supple {

std::vector<std::array<std::size_t, 2>> BodyPassings::find(const std::vector<Positions>& points) {
  std::vector<std::array<std::size_t, 2>> found;
  if (none_left()) return found;
  for (const BodyPairs::Near& pair : pairs_.near(PairKind::passing, points)) {
    if (!share_space(pair.mesh_a, pair.mesh_b)) continue;
    found.push_back({pair.a, pair.b});
    leave_out(pair.a, pair.b);
  }
  return found;
}

}  // namespace supple
