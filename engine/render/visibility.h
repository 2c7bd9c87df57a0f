// Finds which surfaces each pixel shows: at most two, with the samples that show them (the visibility buffer of Burns
// and Hunt 2013). This is done without OpenGL, whose software rasterisers take several times as long for triangles of a
// few pixels, so that pictures do not depend on the driver's rules for edges and samples either.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "render/draw_list.h"
#include "render/sample_buffer.h"
#include "render/tiles.h"

namespace supple {

class Visibility {
 public:
  // The triangles of all meshes are numbered from one, mesh by mesh, in the order of the list.
  Visibility(int width, int height, int samples, const std::vector<DrawMesh>& meshes);

  // Takes other meshes, and numbers their triangles from one again.
  void renew(const std::vector<DrawMesh>& meshes);

  // Finds what a frame shows. positions: x y z by mesh and vertex [m]; view: maps the world to clip coordinates, of
  // which the fourth is the distance along the viewing direction; nearest: the least such distance that is seen [m];
  // pixel: a pixel's edge at distance one. What lies below the ground, y = 0, is not seen.
  void find(const std::vector<DrawMesh>& meshes, const std::vector<std::vector<float>>& positions,
            const Eigen::Matrix4f& view, double nearest, double pixel);

  // Returns two numbers for each pixel, rows from the bottom: its first surface and its second. The lower 24 bits are a
  // triangle, counted from one, or zero; the upper 8 are the samples that show its surface. Only marked tiles are up to
  // date.
  const std::vector<std::uint32_t>& surfaces() const { return surfaces_; }

  int samples() const { return buffer_.samples(); }
  // See SampleBuffer::move_samples.
  void move_samples(double x, double y) { buffer_.move_samples(x, y); }

  Tiles& tiles() { return tiles_; }  // those in which a pixel shows something
  const Tiles& tiles() const { return tiles_; }
  const Tiles& full() const { return full_; }  // those in which all samples show something
  std::vector<float> sample_places() const { return buffer_.places(); }

  // Returns the distance along the viewing direction of what the first sample of a pixel shows; infinity for nothing.
  double distance(int x, int y) const { return 1.0 / std::abs(buffer_.nearness(x, y)[0]); }

 private:
  // Holds a corner of a triangle before it is projected, when the triangle can still be cut: clip coordinates without
  // the third, and the height over the ground.
  struct WorldCorner {
    float x, y, w, height;
  };

  void clear();
  void project(const std::vector<float>& positions, const Eigen::Matrix4f& view);
  WorldCorner corner_at(const float* place, const Eigen::Matrix4f& view) const;
  ScreenCorner on_screen(const WorldCorner& corner) const;
  std::uint8_t outside(const WorldCorner& corner) const;
  void cut(std::vector<WorldCorner>& polygon) const;
  // factor: the factor on the nearness against other meshes; 0 where the mesh is seen where it is.
  void fill(const std::array<ScreenCorner, 3>& corners, std::uint32_t number, const DrawMesh& mesh, float factor);
  void fill_mesh(const DrawMesh& mesh, const std::vector<float>& positions, const Eigen::Matrix4f& view,
                 std::uint32_t number);
  void resolve(float pixel);
  template <int samples>
  bool resolve_tile(int column, int row, float pixel);
  template <int samples>
  void resolve_pixel(const std::uint32_t* numbers, const float* nearness, float pixel, std::uint32_t* surfaces) const;

  int width_, height_;
  float nearest_ = 0;
  SampleBuffer buffer_;
  Tiles tiles_, full_;
  std::vector<std::uint32_t> patches_;  // by triangle: triangles that share vertices have the same number
  std::vector<std::uint32_t> surfaces_;
  std::vector<ScreenCorner> corners_;       // of a mesh, by vertex
  std::vector<std::uint8_t> outside_;       // by vertex: the bounds that it lies beyond, by bit
  std::vector<WorldCorner> polygon_, cut_;  // scratch
};

}  // namespace supple
