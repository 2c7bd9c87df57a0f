// Defines the size and kinds of pictures as a scene describes them.
#pragma once

#include <vector>

#include "base/picture_pass.h"

namespace supple {

struct OutputDef {
  int width = 1280;
  int height = 720;
  double aspect = 0;                     // width over height for which the camera was placed; 0: those of the pictures
  int samples = 4;                       // of antialiasing, a pixel
  int blur_samples = 0;                  // pictures that one with blur is the mean of; 0: as many as the blur asks for
  bool energy = false;                   // whether kinetic, elastic and gravitational energy are computed each frame
  std::vector<PicturePass> passes = {};  // pictures in numbers beside those of the film, in ascending order
};

}  // namespace supple
