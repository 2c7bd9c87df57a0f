// Defines a cloth as a scene describes it. Not here: the fabrics that have names (fabrics.h).
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "base/error.h"
#include "base/names.h"
#include "base/types.h"
#include "sim/materials/membrane.h"

namespace supple {

// Describes what a cloth is made of where it is no net of springs.
struct FabricDef {
  Fabric fabric;
  std::optional<double> usual_density;  // density of a preset [kg/m^2]
};

// Says in which shape each triangle of a surface is at rest.
enum class ClothCut {
  surface,  // as it lies in the file
  texture,  // as it lies flat in the texture, whose coordinates are those of the pieces when they were cut
};
template <>
struct Names<ClothCut> {
  static constexpr std::array table = {Name{ClothCut::surface, "surface"}, Name{ClothCut::texture, "texture"}};
};

// Describes a seam: two stretches of a cloth's border that are drawn together.
struct SeamDef {
  // Points through which each stretch leads, from its first vertex to its last one. They are relative to the bounding
  // box at rest (0 to 1); each stands for the border vertex that is nearest to it.
  std::array<std::vector<Vec3>, 2> sides;
  std::array<FilePlace, 2> places;  // of the sides in the file, for messages once the border is known
};

// Describes a cloth: a grid, the triangles of a mesh file, or those of a surface. It is made of a fabric, or of
// springs.
struct ClothDef {
  std::filesystem::path mesh, surface;             // both empty: a grid
  Eigen::Vector2d extent = Eigen::Vector2d(1, 1);  // width and height of the grid [m]
  Eigen::Vector2i cells = Eigen::Vector2i(40, 40);
  std::optional<double> edge;  // wanted mean length of edges; nothing: the triangles stay as they are [m]
  Vec3 grain = Vec3(0, 1, 0);  // direction of the warp, in the file's frame; projected onto each triangle
  ClothCut cut = ClothCut::surface;
  std::optional<double> cut_scale;  // length of a unit of the texture; nothing: the one that keeps the area [m]
  FilePlace cut_place;              // place of `cut`, for messages once the surface is known
  std::optional<double> sew;        // largest distance between vertices of the border that become one [m]
  std::vector<SeamDef> seams;
  double seam_time = 1;                     // time from the start of the film after which seams are closed [s]
  std::optional<FabricDef> fabric;          // nothing: the cloth is made of springs
  bool curved = false;                      // whether a fabric bends from the file's shape; else it is flat at rest
  double stretch = 0, shear = 0, bend = 0;  // stiffness of a spring [N/m]
};

}  // namespace supple
