// Blurs what moves while the shutter is open, and what is out of focus. A picture is the mean, in linear light, of
// several pictures of the same stage. Each of them has a time of its own, a place of its own on the lens, and a place
// of its own in the pixels, so that the mean has smooth edges too (the accumulation buffer of Haeberli and Akeley
// 1990). Not here: how each of these pictures is drawn (renderer.h).
#pragma once

#include <cstdint>
#include <vector>

#include "render/draw_list.h"

namespace supple {

// Says for one of the pictures when and from where it is seen.
struct ExposureSample {
  double time;                        // 0: the frame before, 1: this frame
  Eigen::Vector2d on_lens, in_pixel;  // on a disc of radius one; from 0 up to 1
};

// Returns the samples in the order of their times. They fill the times, the disc and the pixel evenly, each by itself
// and together.
std::vector<ExposureSample> exposure_samples(const Exposure& exposure, int count);

// Returns how many pictures the exposure of a list needs, so that they do not show as copies of what they blur.
int pictures_needed(const Stage& stage, const DrawList& list);

// Returns the camera of a sample.
Camera camera_of(const DrawList& list, const ExposureSample& sample);

// Writes the positions of all meshes at the time of a sample. Meshes that have other vertices than in the frame before
// stay where they are in this frame.
void positions_of(const DrawList& list, const ExposureSample& sample, std::vector<std::vector<float>>& positions);

// Adds pictures up and returns their mean. Colours count in linear light, each by the coverage of its pixel.
class LightSum {
 public:
  LightSum();

  void add(const Image& image);
  Image mean() const;

 private:
  std::vector<float> linear_;         // by level of sRGB
  std::vector<std::uint8_t> levels_;  // by linear light, in equal steps
  std::vector<float> light_, coverage_;
  int width_ = 0, height_ = 0, pictures_ = 0;
};

}  // namespace supple
