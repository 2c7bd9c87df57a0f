// Decides how triangles from outside become the boundary of a solid. A surface that closed_surface accepts
// (closed_surface.h) stays as it is; others are closed by caps, or by what they wind around, or are given a thickness.
#pragma once

#include <string>
#include <vector>

#include "base/names.h"
#include "geometry/meshes/mesh.h"

namespace supple {

enum class Closing {
  automatic,  // as it is where that is closed, else by caps where holes are all that is wrong, else by winding
  caps,       // each hole by a fan of triangles; all else stays
  winding,    // the solid is where the generalised winding number exceeds 1/2
  never,      // a surface that is not closed is refused
};
template <>
struct Names<Closing> {
  static constexpr std::array table = {Name{Closing::automatic, "auto"}, Name{Closing::caps, "caps"},
                                       Name{Closing::winding, "winding"}, Name{Closing::never, "never"}};
};

// Names the direction of a file that points up: an axis, or the opposite of one. Here y is up.
enum class UpAxis { x, y, z, minus_x, minus_y, minus_z };
template <>
struct Names<UpAxis> {
  static constexpr std::array table = {Name{UpAxis::x, "x"},        Name{UpAxis::y, "y"},
                                       Name{UpAxis::z, "z"},        Name{UpAxis::minus_x, "-x"},
                                       Name{UpAxis::minus_y, "-y"}, Name{UpAxis::minus_z, "-z"}};
};

// Names the unit of a file's coordinates.
enum class LengthUnit { metre, centimetre, millimetre, kilometre, inch, foot };
template <>
struct Names<LengthUnit> {
  static constexpr std::array table = {Name{LengthUnit::metre, "m"},       Name{LengthUnit::centimetre, "cm"},
                                       Name{LengthUnit::millimetre, "mm"}, Name{LengthUnit::kilometre, "km"},
                                       Name{LengthUnit::inch, "in"},       Name{LengthUnit::foot, "ft"}};
};

struct SurfaceOptions {
  Closing close = Closing::automatic;
  double thickness = 0;  // of parts with a rim, 0: they have none [m]
  UpAxis up = UpAxis::y;
  LengthUnit unit = LengthUnit::metre;
  double size = 0;      // the longest side becomes as long as this, 0: it keeps the file's unit [m]
  bool center = false;  // the middle of the box's bottom becomes the origin

  bool operator==(const SurfaceOptions&) const = default;
  // Says all that differs from the defaults; empty where nothing does.
  std::string text() const;
};

// Says how the options turn, scale and move the triangles of one file, so that other places of the file can follow
// them.
struct SetUp {
  SurfaceOptions options;
  Eigen::RowVector3d shift = Eigen::RowVector3d::Zero();  // in metres, after the turn and before `factor`
  double factor = 1;

  Positions placed(Positions points) const;
};
SetUp set_up_of(const TriMesh& raw, const SurfaceOptions& options);

// Returns the triangles turned, scaled and moved as the options say; the same bits where they say nothing.
TriMesh set_up(TriMesh raw, const SurfaceOptions& options);

struct SolidSurface {
  TriMesh boundary;  // closed, facing outward; parts may overlap, whose union is the solid
  TriMesh drawn;     // what is seen of it where that is not the boundary itself; else empty

  const TriMesh& skin() const { return drawn.triangles.rows() > 0 ? drawn : boundary; }
};

// Makes a solid of triangles that have been set up. Adds one line to `notes`, which may be null, for each thing that
// was done. Throws InputError where the options refuse the surface, where numbers are no good, and where no volume is
// enclosed; the message names the option that helps.
SolidSurface solid_surface(const TriMesh& triangles, const SurfaceOptions& options, const std::string& name,
                           std::vector<std::string>* notes);

}  // namespace supple
