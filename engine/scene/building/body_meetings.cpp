#include "scene/building/body_meetings.h"

#include <algorithm>
#include <utility>

#include "geometry/meshes/shared_space.h"

namespace supple {

BodyMeetings::BodyMeetings(const std::vector<Body>& bodies)
    : bodies_(bodies), surfaces_(bodies.size()), looked_for_(bodies.size() * bodies.size(), 0) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) looked_for_[a * bodies.size() + b] = 1;
    left_ += b;
  }
}

void BodyMeetings::leave_out(std::size_t a, std::size_t b) {
  if (a > b) std::swap(a, b);
  if (std::exchange(looked_for_.at(a * bodies_.size() + b), 0) != 0) --left_;
}

const Triangles& BodyMeetings::surface_of(std::size_t body) {
  if (surfaces_[body].rows() == 0) surfaces_[body] = supple::surface_of(bodies_[body]);
  return surfaces_[body];
}

std::vector<std::array<std::size_t, 2>> BodyMeetings::find(const std::vector<Positions>& points) {
  std::vector<std::array<std::size_t, 2>> found;
  if (none_left()) return found;
  std::vector<Bounds> boxes;
  for (const Positions& body : points) boxes.push_back(bounds_of(body));
  const auto mesh = [&](std::size_t body) {
    return PosedMesh{points[body], surface_of(body), bodies_[body].description.mesh.tets, boxes[body]};
  };
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const bool near = (boxes[a].lower.array() <= boxes[b].upper.array()).all() &&
                        (boxes[b].lower.array() <= boxes[a].upper.array()).all();
      if (!near || looked_for_[a * bodies_.size() + b] == 0 || !share_space(mesh(a), mesh(b))) continue;
      found.push_back({a, b});
      leave_out(a, b);
    }
  }
  return found;
}

}  // namespace supple
