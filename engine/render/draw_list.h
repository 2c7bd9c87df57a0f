// What there is to draw, as plain arrays: no GL in it and no physics. A Stage is given once; a DrawList once a frame.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/types.h"

namespace supple {

struct PaintColor {
  Vec3 color;    // sRGB
  double gloss;  // 0 matt to 1 wet
  double soft;   // width of the border, in the unit of DrawMesh::paint
};

enum class Printed { grid, checks };

// A surface whose vertices move and whose other attributes stay.
struct DrawMesh {
  std::string label;                         // caption; empty: none
  std::vector<std::uint32_t> triangles;      // vertex indices, three a triangle, anticlockwise from outside
  std::vector<float> occlusion;              // by vertex: 1 open sky to 0 none
  std::vector<std::array<float, 8>> paint;   // by vertex: signed distance to each layer, negative where it covers
  std::vector<std::array<float, 2>> square;  // by vertex: place in a printed pattern, in squares; empty: no pattern
  Printed printed = Printed::grid;
  bool two_sided = false;          // cloth, and bodies that may be inside out
  Vec3 color;                      // sRGB of the uncovered surface
  double gloss = 0.25;             // of the uncovered surface
  std::vector<PaintColor> layers;  // at most 8
  Bounds rest;                     // where it starts: captions stand below it, cameras frame it [m]
  bool framed = true;              // lights, shadows and cameras care about it: not of planes without end
};

struct Stage {
  std::vector<DrawMesh> meshes;
  int width = 1280, height = 720;  // pixels
  int samples = 4;                 // of antialiasing
  Vec3 ground = Vec3::Ones();      // sRGB
  Vec3 background = Vec3::Ones();  // sRGB
  double exposure = 1;
  std::string font;  // file; empty: no captions
};

struct Camera {
  Vec3 eye = Vec3(0, 0, 3), target = Vec3::Zero();  // [m]
  double fov_deg = 30;                              // vertical
};

struct DrawList {
  Camera camera;
  std::vector<std::vector<float>> positions;                  // by mesh: x y z by vertex [m]
  std::vector<std::pair<std::size_t, DrawMesh>> renewed;      // meshes that take the place of the stage's from now on
  std::vector<std::pair<std::size_t, std::string>> captions;  // of meshes, from now on
};

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // rows from the top
};

}  // namespace supple
