// Fields over meshes as ParaView reads them: VTK's XML files of unstructured grids (.vtu) and collections of them over
// time (.pvd). Numbers are inline base64 of little-endian bytes, each array behind its length as UInt64 ("VTK file
// formats", section XML). Not here: what the fields mean.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/types.h"

namespace supple {

// Values row by row, `components` a point or cell.
struct VtuArray {
  std::string name;
  int components = 1;
  std::variant<std::span<const double>, std::span<const float>, std::span<const std::int32_t>,
               std::span<const std::uint8_t>>
      values;
};

// Cells by their number of corners: three of a triangle, four of a tetrahedron.
struct VtuGrid {
  std::span<const double> points;         // x y z by point [m]
  std::span<const std::int32_t> corners;  // of each cell, into points
  int corners_a_cell = 4;
  std::vector<VtuArray> point_data, cell_data;
};

// Whole or not there. Throws RunError when the disk refuses.
void write_vtu(const std::filesystem::path& path, const VtuGrid& grid);

// Which file shows which time; files beside the collection, by name.
struct PvdEntry {
  double time_s;
  std::string file;
};
void write_pvd(const std::filesystem::path& path, const std::vector<PvdEntry>& entries);

}  // namespace supple
