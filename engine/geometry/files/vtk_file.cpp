// Implements VTK's legacy format of mesh_formats.h, as text: docs.vtk.org, "VTK file formats", versions 2.0 to 5.1.
#include <array>

#include "geometry/files/mesh_formats.h"
#include "geometry/files/mesh_words.h"
#include "geometry/files/vtk_cells.h"

namespace supple {
namespace {

std::vector<long long> read_integers(MeshWords& words, Eigen::Index count, const char* what) {
  std::vector<long long> values;
  for (Eigen::Index i = 0; i < count; ++i) values.push_back(words.number<long long>(what));
  return values;
}

// Reads the cells. In version 5 they are two arrays; in earlier ones, each cell is its number of points and then the
// points.
void read_cells(MeshWords& words, bool arrays, VtkCells& cells) {
  const Eigen::Index first = words.count("cells", 2), second = words.count("numbers of cells", 2);
  if (arrays) {
    if (words.next() != "OFFSETS") words.refuse("OFFSETS should follow CELLS");
    (void)words.next();  // the type of the numbers
    cells.ends = read_integers(words, first, "an offset of a cell");
    if (!cells.ends.empty() && cells.ends.front() != 0)
      words.refuse(fmt::format("the first offset of the cells is {}, not 0", cells.ends.front()));
    if (!cells.ends.empty()) cells.ends.erase(cells.ends.begin());  // the first one is the first cell's start
    if (words.next() != "CONNECTIVITY") words.refuse("CONNECTIVITY should follow OFFSETS");
    (void)words.next();
    cells.points = read_integers(words, second, "a point of a cell");
    return;
  }
  for (Eigen::Index c = 0; c < first; ++c, words.end_row()) {
    const auto points = words.number<long long>("the number of a cell's points");
    if (points < 0 || points + std::ssize(cells.points) + c + 1 > second) {
      words.refuse(fmt::format("{} numbers of cells announced, but the cells hold {} or more", second,
                               points + std::ssize(cells.points) + c + 1));
    }
    for (long long k = 0; k < points; ++k) cells.points.push_back(words.number<long long>("a point of a cell"));
    cells.ends.push_back(std::ssize(cells.points));
    cells.lines.push_back(words.line());
  }
  const Eigen::Index held = std::ssize(cells.points) + first;
  if (held < second) words.refuse(fmt::format("{} numbers of cells announced, but the cells hold {}", second, held));
}

void read_points(MeshWords& words, VtkCells& cells) {
  const Eigen::Index count = words.count("points", 6);
  (void)words.next();  // the type of the numbers
  cells.rest.resize(count, 3);
  for (Eigen::Index v = 0; v < count; ++v, words.end_row())
    for (int k = 0; k < 3; ++k) cells.rest(v, k) = words.number<double>("a coordinate");
}

// Reads the cells' scalars called region, if they are the first ones.
void read_regions(MeshWords& words, VtkCells& cells) {
  const Eigen::Index count = words.count("values of cells", 2);
  if (words.next() != "SCALARS" || words.next() != "region") return;
  (void)words.next();
  words.skip_line();
  if (words.next() != "LOOKUP_TABLE") return;
  words.skip_line();
  cells.regions = read_integers(words, count, "a cell's region");
}

}  // namespace

RawMesh read_legacy_vtk(std::string text, const std::string& name) {
  if (!text.starts_with("# vtk DataFile Version"))
    throw InputError(name, "not a VTK file: it should begin with '# vtk DataFile Version'");
  const std::size_t title = text.find('\n'), rest = title == std::string::npos ? title : text.find('\n', title + 1);
  if (rest == std::string::npos) throw InputError(name, "the file ends after its title");
  for (std::size_t i = title + 1; i < rest; ++i) text[i] = ' ';  // a title may say anything
  const bool arrays = text.size() > 23 && text[23] >= '5';       // the version's first digit
  MeshWords words(std::move(text), name);
  const std::string format(words.next());
  if (format != "ASCII") words.refuse(fmt::format("{} files are not read; ASCII ones are", format.substr(0, 40)));
  if (words.next() != "DATASET" || words.next() != "UNSTRUCTURED_GRID")
    words.refuse("the data set must be an UNSTRUCTURED_GRID");
  VtkCells cells;
  int columns = 0;  // in each row of the section before
  for (;;) {
    words.refuse_further_rows(columns);
    const std::string section(words.next());
    if (section.empty()) break;
    if (section == "POINTS" && cells.rest.rows() == 0) {
      read_points(words, cells);
      columns = 3;
    } else if (section == "CELLS" && cells.ends.empty()) {
      read_cells(words, arrays, cells);
      columns = 0;
    } else if (section == "CELL_TYPES" && cells.types.empty()) {
      cells.types = read_integers(words, words.count("cell types", 2), "a cell's type");
      columns = 1;
    } else if (section == "CELL_DATA" || section == "POINT_DATA") {
      if (section == "CELL_DATA") read_regions(words, cells);
      break;
    } else if (section == "METADATA") {
      do {  // it ends with a blank line
        words.next_line();
      } while (!words.at_line_end() && !words.at_end());
    } else {
      words.refuse(fmt::format("section '{}' is not known here", section.substr(0, 40)));
    }
  }
  return tetrahedra_of(std::move(cells), name);
}

std::string legacy_vtk_text(const TetMesh& mesh) {
  std::string text = "# vtk DataFile Version 3.0\ntetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  text += fmt::format("POINTS {} double\n", mesh.rest.rows());
  for (Eigen::Index v = 0; v < mesh.rest.rows(); ++v)
    text += fmt::format("{:.17g} {:.17g} {:.17g}\n", mesh.rest(v, 0), mesh.rest(v, 1), mesh.rest(v, 2));
  const Eigen::Index count = mesh.tets.rows();
  text += fmt::format("CELLS {} {}\n", count, 5 * count);
  for (Eigen::Index e = 0; e < count; ++e)
    text += fmt::format("4 {} {} {} {}\n", mesh.tets(e, 0), mesh.tets(e, 1), mesh.tets(e, 2), mesh.tets(e, 3));
  text += fmt::format("CELL_TYPES {}\n", count);
  for (Eigen::Index e = 0; e < count; ++e) text += "10\n";
  text += fmt::format("CELL_DATA {}\nSCALARS region int 1\nLOOKUP_TABLE default\n", count);
  for (Eigen::Index e = 0; e < count; ++e)
    text += fmt::format("{}\n", mesh.regions.empty() ? 0 : mesh.regions[std::size_t(e)]);
  return text;
}

}  // namespace supple
