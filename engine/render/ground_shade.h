// Computes what the ground and the background behind it look like on the screen. The ground is seamless: it receives
// the bodies' shadow and contact shade, and fades into the background before its end could be seen. Its colours change
// little from pixel to pixel, so that they are computed at half the picture's resolution, eight places at once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/film_table.h"
#include "render/ground_occlusion.h"
#include "render/stage_light.h"
#include "render/tiles.h"

namespace supple {

// Chooses what pictures have of the ground: all that is seen of it, or its shadows alone, as black with the coverage
// that darkens a picture of the open ground as much as the shadow does.
enum class GroundShown { all, shadows };

// Holds the shares of the key light that reach the ground, by place of half the picture's resolution, rows from the
// bottom; 65,535 is all of it.
using GroundLight = std::vector<std::uint16_t>;

class GroundShade {
 public:
  static constexpr int lanes = Tiles::edge / 2;  // places of half the resolution along the edge of a tile
  using Lanes = Eigen::Array<float, lanes, 1>;

  GroundShade(int width, int height, GroundShown shown);

  // Sets the light and the stage of the calls that follow. stage: x and z of the centre of the ground's lit disc, and
  // its radius [m].
  void set_stage(const StageLight& light, const Vec3& stage);

  // Writes the marked tiles of a picture of the ground on which nothing casts a shadow. picture: four bytes a pixel,
  // red first, rows from the bottom.
  void shade_bare(const Tiles& tiles, std::vector<std::uint32_t>& picture);

  // Does the same with the shadows of bodies, and their contact shade.
  void shade(const Tiles& tiles, const GroundLight& lit, const GroundOcclusion& open,
             std::vector<std::uint32_t>& picture);

  int light_width() const { return light_width_; }  // of GroundLight
  int light_height() const { return light_height_; }

 private:
  void shade_all(const Tiles& tiles, const GroundLight* lit, const GroundOcclusion* open,
                 std::vector<std::uint32_t>& picture);
  void light_tile(int column, int row, const GroundLight* lit, const GroundOcclusion* open);
  void extend_tile(int column, int row);
  void light_places(int left, int y, const Lanes& lit, const GroundOcclusion* open);
  void write_tile(int column, int row, std::vector<std::uint32_t>& picture) const;
  float* plane(int k, int x, int y) { return planes_[std::size_t(k)].data() + index(x, y); }
  const float* plane(int k, int x, int y) const { return planes_[std::size_t(k)].data() + index(x, y); }
  std::size_t index(int x, int y) const { return std::size_t(y + 1) * stride_ + std::size_t(x + 1); }
  int planes() const { return shown_ == GroundShown::all ? 3 : 1; }

  int width_, height_, light_width_, light_height_;
  GroundShown shown_;
  FilmTable film_;
  StageLight light_;
  Vec3 stage_;
  Tiles wanted_;  // scratch: the tiles whose light is computed, which are those to be shaded and their neighbours
  std::size_t stride_;
  // Red, green and blue from 0 to 1, or the coverage of shadows alone, by place of half the resolution, with one more
  // place on each side.
  std::array<std::vector<float>, 3> planes_;
};

}  // namespace supple
