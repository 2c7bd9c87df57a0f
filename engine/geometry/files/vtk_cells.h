// Holds the cells of a VTK file, of either format, and takes the tetrahedra from them.
#pragma once

#include "geometry/files/mesh_formats.h"

namespace supple {

struct VtkCells {
  Positions rest;
  std::vector<long long> points;   // of all cells, one cell after the other
  std::vector<long long> ends;     // of each cell in `points`
  std::vector<long long> types;    // of each cell
  std::vector<long long> regions;  // of each cell; empty: all 0
  std::vector<int> lines;          // of each cell; empty where there are none
};

// Leaves out all other cells. Throws InputError where counts or indices do not fit together.
RawMesh tetrahedra_of(VtkCells cells, const std::string& name);

}  // namespace supple
