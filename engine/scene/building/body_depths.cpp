#include "scene/building/body_depths.h"

#include <fmt/core.h>

#include <algorithm>

#include "geometry/triangles/shared_depth.h"
#include "scene/building/starts_inside.h"
#include "scene/definition/meeting.h"
#include "sim/contact/own_surface.h"

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

std::vector<BodyDepth> bodies_in_themselves(const std::vector<Body>& bodies, const std::vector<Positions>& points) {
  std::vector<BodyDepth> found;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const TetMesh& mesh = bodies[b].description.mesh;
    if (!meets_itself(bodies[b].def) || mesh.tets.rows() == 0) continue;
    const Triangles triangles = boundary_faces(mesh.tets);
    const double size = size_of(bodies[b]);
    MovingSurface moving(triangles, mesh.rest);
    const OwnSurface own(mesh.tets, moving, mesh.rest, size);
    if (!own.overlaps(moving, points[b])) continue;
    moving.set_start(points[b]);
    OwnSurface::Pairs pairs;
    own.find_pairs(moving, points[b], points[b], 0, Vec3::Zero(), pairs);
    BodyDepth deepest{b, b, 0, 0, Vec3::Zero()};
    for (std::size_t i = 0; i < pairs.vertices.size(); ++i) {
      const auto place = own.place_around(moving, points[b], pairs.vertices[i], pairs.of(i));
      if (place && -place->distance > deepest.depth)
        deepest = {b, b, -place->distance, -place->distance / size, points[b].row(pairs.vertices[i]).transpose()};
    }
    if (deepest.share > tolerated_overlap) found.push_back(deepest);
  }
  return found;
}

std::string start_overlap_text(const std::vector<Body>& bodies, const BodyDepth& overlap) {
  if (overlap.a == overlap.b)
    return fmt::format(
        "body '{}' overlaps itself at the start, by up to {:.3g} m ({:.2g} % of its size) at {}: it is pushed apart "
        "gently while the film runs; what is deeper in it than half an edge is left out until it has come apart",
        bodies[overlap.a].def.name, overlap.depth, 100 * overlap.share, place_text(overlap.place));
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
