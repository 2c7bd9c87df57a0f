// Computes where things stand on the screen and which way surfaces face: the arithmetic of drawing, without GL.
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "render/draw_list.h"

namespace supple {

// Returns a camera that has all of the box in view, with some space around it (margin: 1 is none). direction: the
// direction of the view, of length one, from what is seen to the eye. aspect: width over height of the picture.
Camera framing(const Bounds& box, const Vec3& direction, double fov_deg, double margin, double aspect);

// Returns the nearest camera that has all of these points in view, with some space around them. The arguments are those
// of the function above. kept_below: the share of the picture's height that stays free below them.
Camera framing(std::span<const Vec3> points, const Vec3& direction, double fov_deg, double margin, double aspect,
               double kept_below);

// Returns the matrix that maps world to eye coordinates: the eye looks at the target, and up is y.
Eigen::Matrix4f look_at(const Vec3& eye, const Vec3& target);

// Returns the matrix that maps world to clip coordinates. center, reach: the centre and radius of a ball that holds
// everything that can be seen [m].
Eigen::Matrix4f view_matrix(const Camera& camera, double aspect, const Vec3& center, double reach);

// Returns the least distance along the viewing direction that is seen [m]. The arguments are those of view_matrix.
double nearest_seen(const Camera& camera, const Vec3& center, double reach);

// Holds the directions from the eye through the picture: corner + x right + y up for a place in pixels from the lower
// left. They have length one along the viewing direction.
struct Rays {
  Vec3 corner, right, up;
};
Rays rays_through(const Camera& camera, int width, int height);

// Computes smooth normals (x y z and a zero by vertex): each vertex's normal is the sum of its triangles' normals,
// weighted by area. smooth: a number for each vertex; vertices with the same number have one normal, that of all their
// triangles. Empty: each has its own.
void compute_normals(const std::vector<float>& positions, const std::vector<std::uint32_t>& triangles,
                     const std::vector<std::uint32_t>& smooth, float* normals);

}  // namespace supple
