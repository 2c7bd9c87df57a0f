// Finds which parts of the picture surfaces may cover, so that the shading pass runs nowhere else.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace supple {

// Divides a picture into square tiles, each of which is marked or not.
class Tiles {
 public:
  static constexpr int edge = 16;  // pixels

  Tiles(int width, int height);

  void clear();

  // Marks each tile that the box of a triangle touches, and all tiles when a vertex lies behind the camera. positions:
  // x y z by vertex; view: maps the world to clip coordinates; around: the distance from a triangle, along the ground,
  // up to which tiles are marked too, in the unit of the positions.
  void mark(const std::vector<float>& positions, const std::vector<std::uint32_t>& triangles,
            const Eigen::Matrix4f& view, double around = 0);

  // Marks the tiles that are marked in another set of the same picture, or unmarks them.
  void mark(const Tiles& others);
  void unmark(const Tiles& others);

  // Unmarks the tiles of which a neighbour is not marked. Tiles beyond the picture count as marked.
  void narrow();
  // Marks the neighbours of all marked tiles.
  void widen();

  void mark(int column, int row) { marked_[std::size_t(row) * columns_ + column] = 1; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }

  bool marked(int x, int y) const { return marked_[std::size_t(y) * columns_ + x] != 0; }

  // Describes a rectangle of pixels by its lower left corner and its size.
  struct Area {
    int left, low, width, height;
  };
  // Returns the smallest rectangle around all marked tiles; it has no width when none is marked.
  Area around() const;

  // Returns runs of marked tiles as triangles over the picture: six corners for each run, x y each, in clip
  // coordinates. The y of the rows grows upwards, as in clip coordinates.
  const std::vector<float>& corners();

 private:
  bool find_tiles(const std::vector<float>& positions, const Eigen::Matrix4f& view, float around);

  int width_, height_, columns_, rows_;
  std::vector<std::uint8_t> marked_;
  std::vector<float> corners_;
  std::vector<std::int32_t> left_of_, right_of_, low_of_, high_of_;  // by vertex: the tiles around it
};

}  // namespace supple
