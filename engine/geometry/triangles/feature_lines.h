// Finds the lines of a surface that a new mesh of it must keep: open borders, seams where three or more sheets meet,
// edges at which a one-sided surface turns over, sharp creases, and what the caller names. It cuts them at their
// corners, and finds the patches of surface between them. remesh.h is what uses them.
#pragma once

#include <array>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

// Describes a row of edges from one corner to another one, with no corner between them.
struct FeatureLine {
  std::vector<std::int32_t> vertices;  // of the surface, at least two; the first and the last one differ
  std::vector<double> along;           // by vertex: its distance from the first one along the line [m]
  double length() const { return along.back(); }
};

struct SurfaceFeatures {
  std::vector<FeatureLine> lines;
  std::vector<std::array<std::int32_t, 3>> line_of;  // by triangle and side (0: corner 0 to 1): a line; -1: none
  std::vector<char> is_corner;                       // by vertex: a new mesh has a vertex in the same place
  std::vector<std::int32_t> patch;                   // by triangle: the number of its patch; patches end at lines
  std::int32_t patches = 0;
};

struct FeatureLimits {
  double crease = 0;    // the angle between the normals of two triangles beyond which their edge is a crease [rad]
  double shortest = 0;  // the length of creases that hang together below which they do not count [m]
  double corner = 0;    // the least angle by which a line turns at a corner [rad]
  double window = 0;    // the length of line to either side over which its turn is measured [m]
};

// Returns the lines, corners and patches of a surface. mesh: welded; the two triangles at an edge run through it in
// opposite directions where that is possible. named: further edges that are on lines, two vertices each, the lower one
// first. A closed line has at least two corners, so that the way between two places of a line is unique.
SurfaceFeatures features_of(const TriMesh& mesh, const std::vector<std::array<std::int32_t, 2>>& named,
                            const FeatureLimits& limits);

// Returns the point of a line at a distance along it, which is limited to its length [m].
Vec3 point_of(const FeatureLine& line, double along, const Positions& points);

// Returns the number of the segment of a line at a distance along it. Segment i leads from the line's vertex i to the
// next one.
std::size_t segment_of(const FeatureLine& line, double along);

}  // namespace supple
