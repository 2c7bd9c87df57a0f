// Serves both kinds of isosurface stuffing (stuffed_lattice.h, graded_stuffing.h): sorts the corners of an element by
// their side of the surface, makes a mesh of the elements that are kept, and removes two defects that such a mesh
// sometimes has: small loose pieces, and places where the surface touches itself.
#pragma once

#include <array>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

// Sorts the corners of a lattice's element by the sign of the distance there.
template <class Site>
struct CornersBySide {
  std::array<Site, 4> in{}, out{}, on{};
  std::size_t ins = 0, outs = 0, ons = 0;

  // field: returns the distance at a site, 0 where the site was moved onto the surface.
  template <class Field>
  CornersBySide(const std::array<Site, 4>& corners, const Field& field) {
    for (const Site& s : corners) {
      const double value = field(s);
      if (value < 0)
        in[ins++] = s;
      else if (value > 0)
        out[outs++] = s;
      else
        on[ons++] = s;
    }
  }
};

// Makes a mesh without tags, and turns its elements so that their volumes are positive.
TetMesh oriented_mesh(const std::vector<Eigen::RowVector3d>& vertices, const std::vector<std::array<int, 4>>& tets);

// Returns the largest face-connected piece, without the elements at which its boundary is not a manifold (those on the
// smaller side of each place where the boundary touches itself).
TetMesh one_manifold_piece(TetMesh mesh);

}  // namespace supple
