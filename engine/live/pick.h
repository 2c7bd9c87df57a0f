// Finds what a pointer in a picture points at, so that it can be grabbed.
#pragma once

#include <optional>
#include <vector>

#include "render/draw_list.h"
#include "world/world.h"

namespace supple {

// Describes vertices around a place of a body's surface.
struct Pick {
  std::size_t body = 0;
  Vec3 place;                 // that the pointer points at [m]
  std::vector<int> vertices;  // around it, by their numbers in the input file, counted from 1
  double stiffness = 0;       // of a spring at each, so that they follow a pointer against the body's resistance [N/m]
};

// Looks along the ray through a place of a picture, from its upper left corner, 0 to 1. aspect: the picture's width
// over its height. Returns nothing where no body is near it.
std::optional<Pick> pick(const World& world, const Camera& camera, double aspect, const Eigen::Vector2d& place);

// Returns the point on the ray through a place of the picture that lies in the plane through `point`, parallel to the
// picture.
Vec3 point_in_plane(const Camera& camera, double aspect, const Eigen::Vector2d& place, const Vec3& point);

// Returns the height of the picture at the distance of a point [m].
double picture_height_at(const Camera& camera, const Vec3& point);

}  // namespace supple
