// Knows the flat pieces from which a cloth was cut: its texture coordinates, where a scene says that it lies flat in
// them (cut = "texture"). A dress that is modelled on its wearer then has the shape at rest that its pieces had. Not
// here: the energy of a triangle whose flat shape is given (sim/elements/triangle.h), and how triangles are put into
// the model (weaving.h).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/skins/file_corners.h"
#include "scene/building/body.h"

namespace supple {

// Returns the texture coordinates of the corners of a cloth's triangles [units of the texture]. Where some triangles
// are mirrored there, a note tells of them. Throws InputError where triangles have no coordinates, or no area there.
std::vector<std::array<Eigen::Vector2d, 3>> flat_cut(const TriMesh& surface, const FileCorners& corners,
                                                     const ColoredSurface& file, const BodyDef& def,
                                                     std::vector<std::string>& notes);

// Returns how many metres a unit of the texture would be if the cut had the area of the placed surface.
double scale_of_equal_area(const Body& body);

// Returns how many metres a unit of the texture is: as many as the scene says or, where it says nothing, as
// scale_of_equal_area() gives.
double cut_scale(const Body& body);

// Tells how far a cloth is stretched against its cut where it is placed: ratios of lengths, two for each triangle,
// along the directions in which it is stretched most and least.
struct CutStretch {
  double least = 1, median = 1, largest = 1;
  double far = 0;  // share of the triangles with a ratio beyond 1.5 or below 0.67
};
CutStretch cut_stretch(const Body& body);

// Says the scale and the stretch in a sentence.
std::string cut_text(const Body& body);

}  // namespace supple
