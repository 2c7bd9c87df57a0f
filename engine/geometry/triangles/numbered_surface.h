// Holds triangles as they come from a file, cleaned and with the numbers that they had there, and finds how they hang
// together, for the steps that make solids of them (solids/surface_closing.h, winding_solid.h).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct Numbered {
  TriMesh mesh;
  std::vector<Eigen::Index> number;  // the number of each triangle in the file, from 1; 0: it was added here
};

inline std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }
inline Vec3 corner(const TriMesh& mesh, Eigen::Index t, int k) { return mesh.points.row(mesh.triangles(t, k)); }
Vec3 area_vector(const TriMesh& mesh, Eigen::Index t);
// Tells whether the area of a triangle is only round-off.
bool is_flat(const TriMesh& mesh, Eigen::Index t);
void turn_over(Triangles& triangles, Eigen::Index t);

std::string place_text(const Vec3& p);
// Gives "triangle 17 at (x, y, z)".
std::string triangle_text(const Numbered& surface, Eigen::Index t);

// Merges vertices at the same position, numbers them in the order in which the triangles name them, and drops those
// that no triangle names.
TriMesh merged(const TriMesh& raw);

// Returns the listed triangles alone, with all vertices.
Numbered subset(const Numbered& surface, const std::vector<Eigen::Index>& kept);

// Throws InputError where the surface has no triangles, where a triangle names a vertex that is not there, and where a
// triangle's corner is not finite or beyond 1e50.
void check_numbers(const TriMesh& raw, const std::string& name);

// Merges equal positions. Leaves out triangles without area and triangles that repeat others, and counts each kind in a
// note. Throws InputError as check_numbers() does, and where no triangle is left.
Numbered cleaned(const TriMesh& raw, const std::string& name, std::vector<std::string>* notes);

// Describes what a triangle has across its edge from corner k to k + 1.
struct Neighbour {
  Eigen::Index triangle = -1;  // -1 means that the edge is open
  bool alike = false;          // whether the neighbour runs through the edge the other way round, as it should
};

struct Neighbours {
  std::vector<std::array<Neighbour, 3>> of;  // by triangle; edges with more than two triangles count as open
  Eigen::Index crowded = -1;                 // a triangle at an edge with more than two, or -1
};
Neighbours neighbours_of(const Numbered& surface);

// Holds the triangles that are connected through edges, and what is known of them.
struct Component {
  std::vector<Eigen::Index> triangles;
  double area = 0;    // [m^2]
  double volume = 0;  // signed by the way in which most of its area faces in the file [m^3]
  int sense = 1;      // -1 for a cavity
  Bounds box;
};

// Tells which triangles are flipped so that all triangles of a component have one orientation: that of the larger part
// of its area in the file.
struct Flood {
  std::vector<Component> components;
  std::vector<char> turned;
  Eigen::Index one_sided = -1;  // a triangle at which orientations disagree, as on a Moebius strip, or -1
};
Flood flood(const Numbered& surface, const Neighbours& next);

}  // namespace supple
