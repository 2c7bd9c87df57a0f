// Defines the size and kinds of pictures as a scene describes them.
#pragma once

#include <vector>

#include "base/picture_pass.h"

namespace supple {

struct OutputDef {
  int width = 1280;
  int height = 720;
  double aspect = 0;                     // width over height for which the camera was placed; 0: that of the pictures
  int samples = 4;                       // samples a pixel for antialiasing
  int blur_samples = 0;                  // number of pictures of which a blurred one is the mean; 0: the blur decides
  bool energy = false;                   // whether kinetic, elastic and gravitational energy are computed each frame
  std::vector<PicturePass> passes = {};  // pictures in numbers beside those of the film, in ascending order
};

}  // namespace supple
