// Moves the handles that go with a collider or with another body (`attach` of a handle). A collider that deforms
// carries them by its surface, any other collider by its pose, and a body by its surface. When the clock is at 0, the
// handles' vertices are meant to be at their places at rest; from then on these places go along with the carrier. What
// carries the handles does not feel them.
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
  // body: the number of the body that has these handles. All that is passed must outlive this object.
  AttachedHandles(const std::vector<std::unique_ptr<MovingBody>>& bodies, std::size_t body, const CollisionSet& set);

  bool empty() const { return carried_.empty(); }
  // Sets the rows of the attached handles in `targets`, which are in the order of Model::handled, for a time [s].
  // Bodies that carry handles are taken to go on with the velocities that they have.
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
