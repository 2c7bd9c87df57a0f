#include "world/attached_handles.h"

#include "base/error.h"
#include "geometry/shapes/solid_motion.h"
#include "geometry/solids/triangle_solid.h"

namespace supple {
namespace {

template <class List, class Name>
std::size_t index_of(const List& list, const std::string& name, const Name& name_of) {
  std::size_t index = 0;
  while (index < list.size() && name_of(list[index]) != name) ++index;
  SUPPLE_CHECK(index, <, list.size());  // the reader of the scene knows the name
  return index;
}

const std::string& name_of_body(const std::unique_ptr<MovingBody>& body) { return body->body().def.name; }
const std::string& name_of_collider(const SceneCollider& collider) { return collider.def.name; }

// Returns where a body is, by vertex of its mesh, at a time near that of its state [m].
Positions places_of(const MovingBody& body, double time) {
  const State& state = body.state();
  return in_input_order(body.model(), state.x + (time - state.time) * state.v);
}

}  // namespace

AttachedHandles::AttachedHandles(const std::vector<std::unique_ptr<MovingBody>>& bodies, std::size_t body,
                                 const CollisionSet& set)
    : bodies_(bodies), set_(set) {
  const Model& model = bodies[body]->model();
  const std::vector<HandleDef>& handles = bodies[body]->body().def.handles;
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const std::optional<AttachDef>& attach = handles[h].attach;
    if (!attach) continue;
    Carried carried;
    for (std::size_t i = 0; i < model.handled.size(); ++i)
      if (model.handled[i].handle == std::int32_t(h)) carried.rows.push_back(Eigen::Index(i));
    carried.points.resize(std::ssize(carried.rows), 3);
    for (std::size_t i = 0; i < carried.rows.size(); ++i)
      carried.points.row(Eigen::Index(i)) = model.rest.row(model.handled[std::size_t(carried.rows[i])].vertex);
    if (!attach->collider.empty())
      carried.collider = index_of(set.scene_colliders, attach->collider, name_of_collider);
    else
      carried.body = index_of(bodies, attach->body, name_of_body);
    bind(carried);
    carried_.push_back(std::move(carried));
  }
}

void AttachedHandles::bind(Carried& carried) const {
  if (!carried.collider) {
    const Body& body = bodies_[carried.body]->body();
    carried.binding.emplace(TriMesh{scene_start(body), surface_of(body)}, carried.points);
    return;
  }
  const SceneCollider& collider = set_.scene_colliders[*carried.collider];
  if (collider.def.motion)
    carried.binding.emplace(
        TriMesh{world_places(collider, 0), collider.def.motion->motion->solid_at(0)->surface().triangles},
        carried.points);
}

void AttachedHandles::put(double time, Positions& targets) const {
  for (const Carried& carried : carried_) {
    Positions now;
    if (!carried.collider) {
      now = carried.binding->points_at(places_of(*bodies_[carried.body], time));
    } else if (const SceneCollider& collider = set_.scene_colliders[*carried.collider]; carried.binding) {
      now = carried.binding->points_at(world_places(collider, time));
    } else {
      const Eigen::Isometry3d motion = collider.pose(time) * collider.pose(0).inverse();
      now = (carried.points * motion.linear().transpose()).rowwise() + motion.translation().transpose();
    }
    for (std::size_t i = 0; i < carried.rows.size(); ++i) targets.row(carried.rows[i]) = now.row(Eigen::Index(i));
  }
}

}  // namespace supple
