#include "scene/building/body_pairs.h"

#include <utility>

#include "scene/definition/meeting.h"

namespace supple {

BodyPairs::BodyPairs(const std::vector<Body>& bodies)
    : bodies_(bodies), surfaces_(bodies.size()), looked_for_(bodies.size() * bodies.size(), 1) {}

void BodyPairs::look_for(std::size_t a, std::size_t b, bool wanted) {
  if (a > b) std::swap(a, b);
  looked_for_.at(a * bodies_.size() + b) = wanted ? 1 : 0;
}

bool BodyPairs::looks_for(std::size_t a, std::size_t b, PairKind kind) const {
  const BodyDef &one = bodies_[a].def, &other = bodies_[b].def;
  const bool has_inside = meet(one, other) && !(one.cloth && other.cloth);
  return looked_for_[a * bodies_.size() + b] != 0 && has_inside == (kind == PairKind::meeting);
}

bool BodyPairs::has(PairKind kind) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (looks_for(a, b, kind)) return true;
    }
  }
  return false;
}

const Triangles& BodyPairs::surface_of(std::size_t body) {
  if (surfaces_[body].rows() == 0) surfaces_[body] = supple::surface_of(bodies_[body]);
  return surfaces_[body];
}

std::vector<BodyPairs::Near> BodyPairs::near(PairKind kind, const std::vector<Positions>& points) {
  std::vector<Bounds> boxes;
  for (const Positions& body : points) boxes.push_back(bounds_of(body));
  const auto mesh = [&](std::size_t body) {
    return PosedMesh{points[body], surface_of(body), bodies_[body].description.mesh.tets, boxes[body]};
  };
  std::vector<Near> found;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const bool overlap = (boxes[a].lower.array() <= boxes[b].upper.array()).all() &&
                           (boxes[b].lower.array() <= boxes[a].upper.array()).all();
      if (overlap && looks_for(a, b, kind)) found.push_back({a, b, mesh(a), mesh(b)});
    }
  }
  return found;
}

}  // namespace supple
