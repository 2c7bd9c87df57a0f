// Defines tetrahedral and triangle meshes, which are positions and index matrices and nothing more, and functions that
// measure and cut them.
#pragma once

#include <vector>

#include "base/types.h"

namespace supple {

struct TetMesh {
  Positions rest;            // rest positions, n x 3 [m]
  Tetrahedra tets;           // m x 4
  std::vector<int> regions;  // tag of each element; when empty, all are 0
};

struct TriMesh {
  Positions points;     // n x 3 [m]
  Triangles triangles;  // m x 3
};

// Describes a mesh for `supple info` and for warnings.
struct MeshQuality {
  double volume = 0;               // of all elements together [m^3]
  double smallest_volume = 0;      // smallest element volume over the mean volume
  double smallest_dihedral = 180;  // [degrees]
  double largest_dihedral = 0;     // [degrees]
};

double tet_volume(const TetMesh& mesh, Eigen::Index element);
MeshQuality quality(const TetMesh& mesh);

// Returns the faces that belong to one element only, oriented outward, with the mesh's own vertex indices.
Triangles boundary_faces(const Tetrahedra& tets);

// Counts what keeps a boundary from being a manifold. On a manifold, each edge has exactly two faces, the faces around
// each vertex form one fan, and all elements are in one piece.
struct Manifoldness {
  int bad_edges = 0;
  int bad_vertices = 0;
  int pieces = 0;  // number of parts that are connected through faces
};
Manifoldness manifoldness(const TetMesh& mesh);

// Returns the part of a mesh that remains when only the flagged elements are kept; vertices that no element uses are
// dropped.
TetMesh submesh(const TetMesh& mesh, const std::vector<char>& keep);

// Returns the mean length of the edges of triangles, each counted once for each of its triangles [m].
double mean_edge(const Triangles& triangles, const Positions& points);

// Tells which points lie inside an element.
std::vector<char> inside_elements(const TetMesh& mesh, const Positions& points);

// Labels each element with its face-connected piece; pieces are counted from 0 in the order of their first elements.
std::vector<int> face_connected_pieces(const Tetrahedra& tets);

// Scales and moves the whole mesh: q = scale * p + offset.
void transform(TetMesh& mesh, double scale, const Vec3& offset);

}  // namespace supple
