// Moves the handles that go with a collider or with another body (`attach` of a handle). A collider that deforms takes
// them along by its surface, any other one by its pose, and a body by its surface: where they are at rest when the
// clock is at 0, they stay beside it. They pull at nothing: what they go with does not feel them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "geometry/triangles/surface_binding.h"
#include "scene/building/collision_set.h"
#include "world/moving_body.h"

namespace supple {

class AttachedHandles {
 public:
  // body: whose handles these are, by its number among the bodies. All that is passed must outlive this object.
  AttachedHandles(const std::vector<std::unique_ptr<MovingBody>>& bodies, std::size_t body, const CollisionSet& set);

  bool empty() const { return carried_.empty(); }
  // Puts the targets of attached handles at a time [s], in the order of Model::handled. Bodies are taken to go on with
  // the velocities that they have.
  void put(double time, Positions& targets) const;

 private:
  struct Carried {
    std::vector<Eigen::Index> rows;         // of Model::handled
    Positions points;                       // at rest, by row [m]
    std::optional<std::size_t> collider;    // that carries them
    std::size_t body = 0;                   // that carries them, where no collider does
    std::optional<SurfaceBinding> binding;  // nothing: the collider's pose carries them
  };
  void bind(Carried& carried) const;

  const std::vector<std::unique_ptr<MovingBody>>& bodies_;
  const CollisionSet& set_;
  std::vector<Carried> carried_;
};

}  // namespace supple
