// Defines how a scene chooses vertices of a body.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/names.h"
#include "base/texture.h"
#include "base/types.h"

namespace supple {

// Selects vertices of a body by a box, ball, half space or region, by their numbers, as those nearest to points, or by
// what the file of a surface says of them: the name of a group or material, a colour, or a place in the texture where a
// picture is bright. Coordinates are relative to the rest bounding box (0 to 1 along each axis).
struct Selection {
  enum class Kind { region, box, sphere, plane, vertices, nearest, group, color, mask } kind = Kind::box;
  std::string region;
  std::vector<int> vertices;                          // numbers, counted from 1
  Vec3 lower = Vec3(0, 0, 0), upper = Vec3(1, 1, 1);  // box
  Vec3 center = Vec3(0, 0, 0);                        // sphere; a point of the plane
  double radius = 0;                                  // sphere; relative to the longest side
  Vec3 normal = Vec3(0, 1, 0);                        // plane: picks the side that it points to
  std::vector<Vec3> points;                           // nearest
  std::string group;                                  // a name in the file
  Vec3 color = Vec3(0, 0, 0);                         // [sRGB]
  double tolerance = 0.1;                             // by how much each channel of the colour may differ
  std::filesystem::path mask;                         // a picture over the texture coordinates
  std::shared_ptr<const Texture> picture;             // the pixels of the mask; null: they were not read
  double above = 0.5;                                 // brightness above which its pixels select; 0 black, 1 white
  bool border = false;                                // whether only vertices on the open border of a cloth are taken
  FilePlace place;                                    // in the file, for messages once the mesh is known
};

template <>
struct Names<Selection::Kind> {
  using Kind = Selection::Kind;
  static constexpr std::array table = {
      Name{Kind::region, "region"}, Name{Kind::box, "box"},           Name{Kind::sphere, "sphere"},
      Name{Kind::plane, "plane"},   Name{Kind::vertices, "vertices"}, Name{Kind::nearest, "nearest"},
      Name{Kind::group, "group"},   Name{Kind::color, "color"},       Name{Kind::mask, "mask"}};
};

}  // namespace supple
