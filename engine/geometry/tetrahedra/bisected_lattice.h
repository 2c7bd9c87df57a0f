// Makes a lattice of tetrahedra that are as small as each place asks for. Where neighbours are equally large it is
// body-centred cubic; between two sizes elements are bisected at their longest edges until no edge has a vertex of
// another element in its middle. Elements have one of four shapes, with dihedral angles of 45 to 120 degrees, which are
// those of the graded lattice of Labelle and Shewchuk 2007, "Isosurface stuffing".
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "base/types.h"

namespace supple {

struct BisectedLattice {
  std::vector<Eigen::Vector3i> sites;    // in units of the smallest half spacing
  std::vector<std::array<int, 4>> tets;  // of sites, in no particular orientation
  std::vector<double> shortest;          // length of the shortest edge at each site, in the same units
};

// Asks about a part of space: its middle, and a length, in the units of sites.
using LatticeQuestion = std::function<bool(const Vec3& middle, double length)>;

// Makes the lattice. cells: the number of cubic cells along each axis. halvings: how often the spacing of a cell,
// 2^(halvings + 1) units, may be halved. is_needed: whether anything of a cell may belong to the body, by its middle
// and half diagonal. is_too_large: whether an element there may not have this spacing; not asked about the smallest.
// The elements of a cell have a twelfth of its volume, and elements of the same volume have the same spacing.
BisectedLattice bisected_lattice(const Eigen::Vector3i& cells, int halvings, const LatticeQuestion& is_needed,
                                 const LatticeQuestion& is_too_large);

}  // namespace supple
