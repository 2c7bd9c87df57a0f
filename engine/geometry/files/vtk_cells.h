// Holds the cells of a VTK file, of either format, and takes the tetrahedra from them.
#pragma once

#include "geometry/files/mesh_formats.h"

namespace supple {

struct VtkCells {
  Positions rest;
  std::vector<long long> points;   // the point numbers of all cells, one cell after the other
  std::vector<long long> ends;     // where each cell ends in `points`
  std::vector<long long> types;    // the VTK type of each cell
  std::vector<long long> regions;  // the region tag of each cell; empty: all are 0
  std::vector<int> lines;          // the line of each cell in the file; empty where cells have none
};

// Returns the mesh of the tetrahedra, without all other cells. Throws InputError where counts or indices do not fit
// together.
RawMesh tetrahedra_of(VtkCells cells, const std::string& name);

}  // namespace supple
