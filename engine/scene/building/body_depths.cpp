#include "scene/building/body_depths.h"

#include <fmt/core.h>

#include <algorithm>

#include "geometry/triangles/shared_depth.h"
#include "scene/building/overlaps.h"

namespace supple {
namespace {

double size_of(const Body& body) { return bounds_of(body.description.mesh.rest).diagonal(); }

BodyDepth depth_of(const std::vector<Body>& bodies, const BodyPairs::Near& pair) {
  const SharedDepth deepest = shared_depth(pair.mesh_a, pair.mesh_b);
  const double size = std::min(size_of(bodies[pair.a]), size_of(bodies[pair.b]));
  return {pair.a, pair.b, deepest.depth, deepest.depth / size, deepest.place};
}

std::string place_text(const Vec3& place) {
  return fmt::format("[{:.3g}, {:.3g}, {:.3g}]", place.x(), place.y(), place.z());
}

}  // namespace

std::vector<BodyDepth> overlaps_of_bodies(const std::vector<Body>& bodies, const std::vector<Positions>& points) {
  std::vector<BodyDepth> found;
  BodyPairs pairs(bodies);
  if (!pairs.has(PairKind::meeting)) return found;
  for (const BodyPairs::Near& pair : pairs.near(PairKind::meeting, points)) {
    if (!share_space(pair.mesh_a, pair.mesh_b)) continue;
    const BodyDepth overlap = depth_of(bodies, pair);
    if (overlap.depth <= 0 || overlap.share > tolerated_overlap) found.push_back(overlap);
  }
  return found;
}

std::string start_overlap_text(const std::vector<Body>& bodies, const BodyDepth& overlap) {
  const std::string pair =
      fmt::format("bodies '{}' and '{}' overlap at the start", bodies[overlap.a].def.name, bodies[overlap.b].def.name);
  if (overlap.depth <= 0)
    return pair + ", with no vertex of one inside the other: contact finds vertices, and may leave them there";
  return fmt::format(
      "{}, by up to {:.3g} m ({:.2g} % of the smaller one's size) at {}: they are pushed apart gently while the film "
      "runs",
      pair, overlap.depth, 100 * overlap.share, place_text(overlap.place));
}

std::vector<BodyDepth> DeepBodies::find(const std::vector<Positions>& points) {
  std::vector<BodyDepth> found;
  if (none_left()) return found;
  for (const BodyPairs::Near& pair : pairs_.near(PairKind::meeting, points)) {
    const BodyDepth overlap = depth_of(bodies_, pair);
    if (overlap.share <= deep) continue;
    found.push_back(overlap);
    leave_out(pair.a, pair.b);
  }
  return found;
}

}  // namespace supple
