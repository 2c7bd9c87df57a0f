// Says what lights, shadows and the ground cover in a frame. While everything stays where the film begins, they cover
// what is there and keep their places, so that nothing shimmers. What leaves is followed: the lit disc of the ground
// grows and moves without jumps, shadow map and contact shade move by whole texels. All of it depends on the frame
// alone, so that frames may be drawn in any order.
#pragma once

#include <vector>

#include "render/draw_list.h"

namespace supple {

class StageCover {
 public:
  StageCover(const Stage& stage, const Vec3& to_light);

  // Describes what is covered in a frame [m].
  struct Frame {
    Vec3 light_center;    // of the ground's lit disc
    double light_radius;  // of that disc
    Vec3 shadow_center;   // of the ball that the shadow map covers
    double shadow_radius;
    Vec3 shade_center;    // of the square of the ground in which contact shade is computed
    double shade_extent;  // edge of the square
    bool operator==(const Frame&) const = default;
  };
  Frame at(const std::vector<DrawMesh>& meshes, const DrawList& list) const;

  const Frame& at_rest() const { return rest_; }
  const Bounds& bounds() const { return bounds_; }                     // of the stage at rest, with the ground below it
  double largest_body() const { return largest_body_; }                // its diagonal [m]
  double reach() const { return bounds_.diagonal() + largest_body_; }  // how far the stage goes from its centre [m]

 private:
  struct Ball {
    Vec3 center;
    double radius;
  };
  bool is_seen(const Camera& camera, const Ball& ball) const;
  Ball shadow_of(const Ball& ball) const;
  void follow_with_light(const std::vector<Ball>& balls, const DrawList& list, Frame& frame) const;
  void follow_with_shadow(const std::vector<Ball>& balls, Frame& frame) const;
  void follow_with_shade(const std::vector<Ball>& balls, Frame& frame) const;

  double aspect_;
  Bounds bounds_;
  double largest_body_;
  Vec3 to_light_, right_, up_;  // unit vectors; the last two span the shadow map
  Frame rest_;
};

}  // namespace supple
