// Tetrahedral and triangle meshes: positions and index matrices, nothing more, and what can be said of them.
#pragma once

#include <vector>

#include "base/types.h"

namespace supple {

struct TetMesh {
  Positions rest;            // rest positions, n x 3 [m]
  Tetrahedra tets;           // m x 4
  std::vector<int> regions;  // tag of each element; empty: all 0
};

struct TriMesh {
  Positions points;     // n x 3 [m]
  Triangles triangles;  // m x 3
};

// What a mesh is like, for `supple info` and for warnings.
struct MeshQuality {
  double volume = 0;               // of all elements [m^3]
  double smallest_volume = 0;      // over the mean volume
  double smallest_dihedral = 180;  // [degrees]
  double largest_dihedral = 0;     // [degrees]
};

double tet_volume(const TetMesh& mesh, Eigen::Index element);
MeshQuality quality(const TetMesh& mesh);

// Faces that belong to one element, outward; the indices are the mesh's vertices.
Triangles boundary_faces(const Tetrahedra& tets);

// A boundary without loose ends: each edge on exactly two faces, the faces around each vertex one fan; all elements in
// one piece.
struct Manifoldness {
  int bad_edges = 0;
  int bad_vertices = 0;
  int pieces = 0;  // parts connected through faces
};
Manifoldness manifoldness(const TetMesh& mesh);

// The piece of a mesh that remains when only the flagged elements are kept; vertices that nobody uses are dropped.
TetMesh submesh(const TetMesh& mesh, const std::vector<char>& keep);

// For each element the label of its face-connected piece, counted from 0 in order of the first element.
std::vector<int> face_connected_pieces(const Tetrahedra& tets);

// The whole mesh scaled and moved: q = scale * p + offset.
void transform(TetMesh& mesh, double scale, const Vec3& offset);

}  // namespace supple
