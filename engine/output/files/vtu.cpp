#include "output/files/vtu.h"

#include <fmt/core.h>

#include <bit>
#include <cstring>

#include "base/error.h"
#include "output/files/markup.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

static_assert(std::endian::native == std::endian::little, "files are little-endian");

constexpr std::uint8_t triangle_type = 5, tetrahedron_type = 10;  // VTK's numbers

template <class T>
constexpr const char* vtk_type = nullptr;
template <>
constexpr const char* vtk_type<double> = "Float64";
template <>
constexpr const char* vtk_type<float> = "Float32";
template <>
constexpr const char* vtk_type<std::int32_t> = "Int32";
template <>
constexpr const char* vtk_type<std::uint8_t> = "UInt8";

template <class T>
void append_array(const std::string& name, int components, std::span<const T> values, std::string& text) {
  const std::uint64_t length = values.size_bytes();
  std::vector<std::uint8_t> bytes(sizeof length + length);
  std::memcpy(bytes.data(), &length, sizeof length);
  if (length > 0) std::memcpy(bytes.data() + sizeof length, values.data(), length);
  text += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">\n", vtk_type<T>,
                      markup_text(name), components);
  text += base64_text(bytes) + "\n</DataArray>\n";
}

void append_data(const char* element, const std::vector<VtuArray>& arrays, std::size_t rows, std::string& text) {
  text += fmt::format("<{}>\n", element);
  for (const VtuArray& array : arrays) {
    std::visit(
        [&](const auto& values) {
          SUPPLE_CHECK(values.size(), ==, rows * array.components);
          append_array(array.name, array.components, values, text);
        },
        array.values);
  }
  text += fmt::format("</{}>\n", element);
}

void append_cells(const VtuGrid& grid, std::size_t cells, std::string& text) {
  std::vector<std::int32_t> ends(cells);
  for (std::size_t cell = 0; cell < cells; ++cell)
    ends[cell] = static_cast<std::int32_t>((cell + 1) * grid.corners_a_cell);
  const std::vector<std::uint8_t> types(cells, grid.corners_a_cell == 3 ? triangle_type : tetrahedron_type);
  text += "<Cells>\n";
  append_array("connectivity", 1, grid.corners, text);
  append_array("offsets", 1, std::span<const std::int32_t>(ends), text);
  append_array("types", 1, std::span<const std::uint8_t>(types), text);
  text += "</Cells>\n";
}

constexpr const char* xml_start =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" "
    "header_type=\"UInt64\">\n";

}  // namespace

void write_vtu(const std::filesystem::path& path, const VtuGrid& grid) {
  SUPPLE_CHECK(grid.corners_a_cell == 3 || grid.corners_a_cell == 4, ==, true);
  const std::size_t points = grid.points.size() / 3, cells = grid.corners.size() / grid.corners_a_cell;
  std::string text = fmt::format(fmt::runtime(xml_start), "UnstructuredGrid");
  text += fmt::format("<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", points, cells);
  append_data("PointData", grid.point_data, points, text);
  append_data("CellData", grid.cell_data, cells, text);
  text += "<Points>\n";
  append_array("position", 3, grid.points, text);
  text += "</Points>\n";
  append_cells(grid, cells, text);
  text += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  write_whole_file(path, text);
}

void write_pvd(const std::filesystem::path& path, const std::vector<PvdEntry>& entries) {
  std::string text = fmt::format(fmt::runtime(xml_start), "Collection") + "<Collection>\n";
  for (const PvdEntry& entry : entries)
    text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", entry.time_s, markup_text(entry.file));
  write_whole_file(path, text + "</Collection>\n</VTKFile>\n");
}

}  // namespace supple
