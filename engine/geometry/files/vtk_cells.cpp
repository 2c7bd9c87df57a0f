#include "geometry/files/vtk_cells.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "base/error.h"

namespace supple {
namespace {

constexpr long long vtk_tetrahedron = 10, vtk_quadratic_tetrahedron = 24;  // numbers of the types

[[noreturn]] void refuse(const VtkCells& cells, std::size_t cell, const std::string& name, const std::string& message) {
  if (cells.lines.empty()) throw InputError(name, fmt::format("cell {}: {}", cell + 1, message));
  throw InputError({Problem{{name, cells.lines[cell]}, message}});
}

// Tells whether cells of a type other than the two above have a volume: voxels, hexahedra, wedges, pyramids and the
// like, and polyhedra.
bool has_volume(long long type) {
  constexpr std::array<long long, 26> volumes = {11, 12, 13, 14, 15, 16, 25, 26, 27, 29, 31, 32, 33,
                                                 37, 41, 42, 64, 65, 66, 67, 71, 72, 73, 74, 78, 79};
  return std::find(volumes.begin(), volumes.end(), type) != volumes.end();
}

void check_counts(const VtkCells& cells, const std::string& name) {
  const auto same = [&](std::size_t count, const char* what) {
    if (count != cells.ends.size())
      throw InputError(name, fmt::format("{} cells, but {} {}", cells.ends.size(), count, what));
  };
  same(cells.types.size(), "types of cells");
  if (!cells.regions.empty()) same(cells.regions.size(), "regions of cells");
  if (!cells.ends.empty() && cells.ends.back() < std::ssize(cells.points))
    throw InputError(
        name, fmt::format("the cells have {} points, but {} are listed", cells.ends.back(), cells.points.size()));
}

}  // namespace

RawMesh tetrahedra_of(VtkCells cells, const std::string& name) {
  check_counts(cells, name);
  RawMesh raw;
  std::vector<std::array<std::int32_t, 4>> tets;
  long long begin = 0;
  long long others = 0;  // cells with a volume that are no such tetrahedra
  bool quadratic = false;
  for (std::size_t c = 0; c < cells.ends.size(); begin = cells.ends[c], ++c) {
    if (cells.ends[c] < begin || cells.ends[c] > std::ssize(cells.points))
      refuse(cells, c, name, fmt::format("it ends at {} of {} points", cells.ends[c], cells.points.size()));
    if (cells.types[c] != vtk_tetrahedron && cells.types[c] != vtk_quadratic_tetrahedron) {
      others += has_volume(cells.types[c]) ? 1 : 0;
      continue;
    }
    const long long count = cells.ends[c] - begin, wanted = cells.types[c] == vtk_tetrahedron ? 4 : 10;
    if (count != wanted) refuse(cells, c, name, fmt::format("a tetrahedron of {} points; it has {}", count, wanted));
    std::array<std::int32_t, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) {
      const long long v = cells.points[std::size_t(begin) + k];
      if (v < 0 || v >= cells.rest.rows())
        refuse(cells, c, name, fmt::format("point {} does not exist: there are {} (from 0)", v, cells.rest.rows()));
      corners[k] = std::int32_t(v);
    }
    const long long region = cells.regions.empty() ? 0 : cells.regions[c];
    if (region < 0 || region > largest_reference)
      refuse(cells, c, name, fmt::format("region {} is outside 0 to {}", region, largest_reference));
    quadratic |= wanted == 10;
    tets.push_back(corners);
    raw.mesh.regions.push_back(int(region));
    if (!cells.lines.empty()) raw.lines.push_back(cells.lines[c]);
  }
  if (tets.empty()) throw InputError(name, "the file has no tetrahedra");
  if (quadratic) raw.notes.emplace_back("of elements of the second order only the corners are used");
  if (others > 0) raw.notes.push_back(left_out_note(others));
  raw.mesh.rest = std::move(cells.rest);
  raw.mesh.tets.resize(std::ssize(tets), 4);
  for (std::size_t e = 0; e < tets.size(); ++e)
    for (int k = 0; k < 4; ++k) raw.mesh.tets(Eigen::Index(e), k) = tets[e][std::size_t(k)];
  return raw;
}

}  // namespace supple
