// Writes fields over meshes in the form that ParaView reads: VTK's XML files of unstructured grids (.vtu), and
// collections of them over time (.pvd). Numbers are inline base64 of little-endian bytes, and the length of each array
// comes before it as UInt64 ("VTK file formats", section XML). The meaning of the fields is not known here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/types.h"

namespace supple {

// Holds values row by row, `components` for each point or cell.
struct VtuArray {
  std::string name;
  int components = 1;
  std::variant<std::span<const double>, std::span<const float>, std::span<const std::int32_t>,
               std::span<const std::uint8_t>>
      values;
};

// Describes cells by their corners: three make a triangle, four a tetrahedron.
struct VtuGrid {
  std::span<const double> points;         // x y z by point [m]
  std::span<const std::int32_t> corners;  // of each cell, as indices of points
  int corners_a_cell = 4;
  std::vector<VtuArray> point_data, cell_data;
};

// Writes the grid. The file is either complete or absent. Throws RunError when it cannot be written.
void write_vtu(const std::filesystem::path& path, const VtuGrid& grid);

// Names the file that shows a time; the files lie in the same folder as the collection and are given by name.
struct PvdEntry {
  double time_s;
  std::string file;
};
void write_pvd(const std::filesystem::path& path, const std::vector<PvdEntry>& entries);

}  // namespace supple
