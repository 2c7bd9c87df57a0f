// Where things stand on the screen, and which way surfaces face: the arithmetic of drawing, without GL.
#pragma once

#include <Eigen/Geometry>

#include "render/draw_list.h"

namespace supple {

// A camera a little above eye level that has all of the box in view, with air around it.
Camera framing(const Bounds& box, double fov_deg, double margin, double aspect);

// World to eye coordinates: the eye looks at the target, up is y.
Eigen::Matrix4f look_at(const Vec3& eye, const Vec3& target);

// World to clip coordinates. center, reach: a ball that holds what there is to see [m].
Eigen::Matrix4f view_matrix(const Camera& camera, double aspect, const Vec3& center, double reach);

// Smooth normals (x y z by vertex): each vertex's is the sum of its triangles', weighted by area.
void compute_normals(const std::vector<float>& positions, const std::vector<std::uint32_t>& triangles,
                     std::vector<float>& normals);

}  // namespace supple
