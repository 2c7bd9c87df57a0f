// Maps points of the world to pixels of a picture.
#pragma once

#include <optional>

#include "render/caption_layout.h"
#include "render/draw_list.h"

namespace supple {

class Projection {
 public:
  // around: all that is drawn [m].
  Projection(const Camera& camera, const Bounds& around, int width, int height);

  // Returns the pixel of a point, counted from the upper left corner; nothing for points behind the eye.
  std::optional<Eigen::Vector2d> operator()(const Vec3& point) const;

  // Returns the outline of a box; empty when part of it lies behind the eye.
  Outline outline(const Bounds& box) const;

 private:
  Eigen::Matrix4f view_;
  int width_, height_;
};

// Returns the box around all meshes that cameras frame, as they are at the start [m].
Bounds framed_at_start(const Stage& stage);

}  // namespace supple
