// Draws pictures of a world as it is, and reads fields off it, for programs that move a world themselves. A film draws
// its pictures while it is made (pictures.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/draw_list.h"
#include "scene/building/drawn_body.h"
#include "world/world.h"

namespace supple {

class WorldPictures {
 public:
  // The world must have a script and have been started; it and the threads must outlive this object.
  WorldPictures(World& world, Threads& threads);
  ~WorldPictures();
  WorldPictures(const WorldPictures&) = delete;
  WorldPictures& operator=(const WorldPictures&) = delete;

  // Draws the world at the end of its last frame. settings: path=value, in place of the scene's values: the camera, the
  // look, the size of the picture, a field. Pictures that differ by the camera alone share the preparations. Throws
  // InputError, and RunError where there is no OpenGL.
  Image draw(const std::vector<std::string>& settings);

  // Returns the values of a quantity by vertex of each body's mesh, in the units of scene files; empty for bodies that
  // do not have it. Throws InputError when none has.
  std::vector<std::vector<double>> field(FieldQuantity quantity);

 private:
  class Studio;
  struct Pose;
  Pose present_pose();

  World& world_;
  Threads& threads_;
  std::vector<DrawnBody> skins_, elements_;  // by body; made when they are first drawn
  std::unique_ptr<Studio> studio_;           // of the last picture
};

}  // namespace supple
