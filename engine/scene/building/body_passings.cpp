#include "scene/building/body_passings.h"

#include "scene/definition/meeting.h"
#include "sim/contact/own_sheet.h"

namespace supple {

struct BodyPassings::Cloth {
  MovingSurface moving;
  OwnSheet sheet;

  explicit Cloth(const Body& body)
      : moving(body.cloth.surface.triangles, body.description.mesh.rest),
        sheet(moving, body.description.mesh.rest, joined_by_seams(body.description.seams)) {}
};

BodyPassings::BodyPassings(const std::vector<Body>& bodies)
    : bodies_(bodies), pairs_(bodies), cloths_(bodies.size()), left_out_(bodies.size(), 0) {}
BodyPassings::~BodyPassings() = default;

void BodyPassings::leave_out(std::size_t a, std::size_t b) {
  if (a == b) {
    left_out_.at(a) = 1;
  } else {
    pairs_.leave_out(a, b);
  }
}

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

bool BodyPassings::crosses_itself(std::size_t body, const Positions& points) {
  const Body& of = bodies_[body];
  if (!of.def.cloth || left_out_[body] != 0 || !meets_itself(of.def)) return false;
  std::unique_ptr<Cloth>& cloth = cloths_[body];
  if (cloth == nullptr) cloth = std::make_unique<Cloth>(of);
  cloth->moving.set_end(points);
  cloth->moving.set_start(points);
  if (!cloth->sheet.crossing(cloth->moving, points)) return false;
  leave_out(body, body);
  return true;
}

}  // namespace supple
