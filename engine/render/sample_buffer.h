// Rasterises triangles with several samples a pixel: each sample keeps the number of the nearest triangle. There are
// neither colours nor attributes, so a small triangle costs little more than its samples.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace supple {

// Describes a corner of a triangle on the screen.
struct ScreenCorner {
  std::int32_t x, y;  // in parts of a pixel, from the lower left of the picture
  float nearness;     // one over the distance along the viewing direction [1/m]
};

enum class Samples { all, every_second };
enum class Facing { towards, both };  // anticlockwise triangles alone, or clockwise ones too

class SampleBuffer {
 public:
  static constexpr int parts = 256;  // of a pixel along each edge
  // Corners may lie this far from the origin [parts], beyond the picture too.
  static constexpr std::int32_t furthest = 1 << 24;

  // samples: 1, 2, 4 or 8, in the places that Direct3D and Vulkan name standard.
  SampleBuffer(int width, int height, int samples);

  int samples() const { return samples_; }
  // Moves the samples of all pixels from their standard places [parts of a pixel, from 0 up to 1]. A sample that leaves
  // its pixel comes in at the other side.
  void move_samples(double x, double y);
  // Returns the places of the samples in a pixel from its lower left, x y each, from 0 to 1.
  std::vector<float> places() const;

  // Empties the samples of some pixels of a row.
  void clear(int y, int from, int to);

  // Describes pixels, the last ones included; empty where the last lie before the first.
  struct Box {
    int left, right, low, high;
  };
  // Writes a triangle into the samples that it covers and in which it is nearest. number: not zero. Where triangles
  // share an edge, each sample on it belongs to one of them. Returns the pixels that it may have covered.
  Box fill(const std::array<ScreenCorner, 3>& corners, std::uint32_t number, Facing facing, Samples which);
  // Does the same for a triangle that is seen as if it were nearer by a factor, at least 1, than it is. Among
  // themselves such triangles hide each other by where they are. They must be filled after all others.
  Box fill_lifted(const std::array<ScreenCorner, 3>& corners, std::uint32_t number, float factor);

  // Returns the numbers of the triangles that a pixel's samples show, zero where a sample shows none.
  const std::uint32_t* numbers(int x, int y) const { return &numbers_[at(x, y)]; }
  // Returns the nearness of what a pixel's samples show; negative where that is a lifted triangle.
  const float* nearness(int x, int y) const { return &nearness_[at(x, y)]; }

 private:
  static constexpr int lanes = 8;

  // Describes what is written for a triangle: its number, the samples into which it goes, and the factor of a lifted
  // one.
  struct Written {
    std::uint32_t number;
    Samples which;
    float factor;
  };
  template <bool lifted>
  Box fill_as(const std::array<ScreenCorner, 3>& corners, Facing facing, const Written& written);
  template <class Integer, bool lifted>
  void cover(const std::array<ScreenCorner, 3>& corners, const Box& box, double area, const Written& written);
  std::size_t at(int x, int y) const { return (std::size_t(y) * stride_ + x) * samples_; }

  void place_lanes();

  int width_, height_, samples_;
  int moved_x_ = 0, moved_y_ = 0;  // by move_samples() [parts]
  std::size_t stride_;             // pixels of a row, with room for the last register
  // By lane of a register, which begins at a pixel's first sample: the sample's place from that pixel's corner [parts].
  std::array<std::int32_t, lanes> lane_x_, lane_y_;
  std::array<std::array<std::int32_t, lanes>, 2> allowed_;  // by value of Samples: -1 in lanes that are written
  std::vector<std::uint32_t> numbers_;
  std::vector<float> nearness_;
};

}  // namespace supple
