// Finds which bodies of a world may touch in a step, by the ways that they would go if nothing touched them. Bodies
// that may touch, directly or through others, are an island. Islands depend on nothing but the states at the beginning
// of the step, so that a film that is resumed finds the same ones.
#pragma once

#include <memory>
#include <vector>

#include "geometry/triangles/moving_surface.h"
#include "world/moving_body.h"

namespace supple {

struct SceneDef;

class IslandFinder {
 public:
  // All that is passed must outlive this object. bodies: those of the scene, in its order.
  IslandFinder(const SceneDef& scene, const std::vector<std::unique_ptr<MovingBody>>& bodies);
  ~IslandFinder();

  // Returns the islands of the step that was prepared, in the order of their first bodies. Each is a list of its bodies
  // in the order of the scene. A body that no other one may touch is an island of its own.
  std::vector<std::vector<std::size_t>> find();

 private:
  struct Way;  // of a body over the step that was prepared

  void find_ways();
  bool may_touch(std::size_t a, std::size_t b, double pushed) const;
  bool is_within(std::size_t inner, std::size_t outer) const;
  bool may_be_stopped(std::size_t body) const;
  MovingSurface& surface_of(std::size_t body) const;

  const SceneDef& scene_;
  const std::vector<std::unique_ptr<MovingBody>>& bodies_;
  std::vector<Way> ways_;  // by body
};

}  // namespace supple
