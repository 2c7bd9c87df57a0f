// Implements MEDIT of mesh_formats.h, and the triangles of such files for cloth.
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "base/error.h"
#include "geometry/files/mesh_file.h"
#include "geometry/files/mesh_formats.h"
#include "geometry/files/mesh_words.h"

namespace supple {
namespace {

// Holds a file as it stands; its indices have been checked.
struct Sections {
  RawMesh raw;
  Triangles triangles;
  std::vector<int> triangle_lines;
};

// Reads rows of `columns` vertex indices and a reference, and passes each to row(i, count, indices, reference), where
// count is the number of all rows.
template <class Row>
void read_rows(MeshWords& words, const char* what, int columns, Eigen::Index vertices, std::vector<int>& lines,
               const Row& row) {
  const Eigen::Index count = words.count(what, static_cast<std::size_t>(2 * columns + 2));
  for (Eigen::Index i = 0; i < count; ++i) {
    std::array<std::int32_t, 4> corner{};
    for (int k = 0; k < columns; ++k) {
      const auto v = words.number<long long>("a vertex of an element");
      if (v < 1 || v > vertices) {
        words.refuse(
            fmt::format("vertex {} does not exist: there are {} (vertices count from 1, and stand before the elements)",
                        v, vertices));
      }
      corner[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(v - 1);
    }
    lines.push_back(words.line());
    const auto reference = words.number<long long>("an element's reference");
    if (reference < 0 || reference > 1'000'000)
      words.refuse(fmt::format("reference {} is outside 0 to 1000000", reference));
    row(i, count, corner, static_cast<int>(reference));
    words.end_row();
  }
}

// Skips a section of rows of integers that is of no use here. Returns the number of integers in a row.
int skip_section(MeshWords& words, std::string_view section) {
  struct Skipped {
    std::string_view name;
    int integers;
  };
  constexpr Skipped skipped[] = {{"Triangles", 4},     {"Tetrahedra", 5},       {"Edges", 3},
                                 {"Corners", 1},       {"Ridges", 1},           {"RequiredVertices", 1},
                                 {"RequiredEdges", 1}, {"RequiredTriangles", 1}};
  const auto* known =
      std::find_if(std::begin(skipped), std::end(skipped), [&](const Skipped& s) { return s.name == section; });
  if (known == std::end(skipped)) words.refuse(fmt::format("section '{}' is not known", section.substr(0, 40)));
  const Eigen::Index count = words.count(known->name, static_cast<std::size_t>(2 * known->integers));
  for (Eigen::Index i = 0; i < count; ++i, words.end_row())
    for (int k = 0; k < known->integers; ++k) (void)words.number<long long>("an index");
  return known->integers;
}

enum class Wanted { tetrahedra, triangles };

Sections read_sections(MeshWords& words, Wanted wanted) {
  if (words.next() != "MeshVersionFormatted")
    words.refuse("not a MEDIT mesh: it should begin with MeshVersionFormatted");
  const int version = words.number<int>("the version");
  if (version < 1 || version > 4)
    words.refuse(fmt::format("version {} of the format is not known (1 to 4 are)", version));
  Sections read;
  TetMesh& mesh = read.raw.mesh;
  int columns = 1;  // in a row of the section before
  for (;;) {
    words.refuse_further_rows(columns);
    const std::string_view section = words.next();
    if (section.empty() || section == "End") return read;
    if (section == "Dimension") {
      if (words.number<int>("the dimension") != 3) words.refuse("the dimension must be 3");
    } else if (section == "Vertices") {
      if (mesh.rest.rows() > 0) words.refuse("a second Vertices section");
      const Eigen::Index count = words.count("vertices", 8);
      columns = 4;
      mesh.rest.resize(count, 3);
      for (Eigen::Index v = 0; v < count; ++v) {
        for (int k = 0; k < 3; ++k) mesh.rest(v, k) = words.number<double>("a coordinate");
        (void)words.number<long long>("a vertex's reference");
        words.end_row();
      }
    } else if (section == "Tetrahedra" && wanted == Wanted::tetrahedra) {
      if (mesh.tets.rows() > 0) words.refuse("a second Tetrahedra section");
      columns = 5;
      read_rows(words, "elements", 4, mesh.rest.rows(), read.raw.lines,
                [&](Eigen::Index i, Eigen::Index count, const auto& corner, int reference) {
                  if (i == 0) mesh.tets.resize(count, 4);
                  mesh.tets.row(i) << corner[0], corner[1], corner[2], corner[3];
                  mesh.regions.push_back(reference);
                });
    } else if (section == "Triangles" && wanted == Wanted::triangles) {
      if (read.triangles.rows() > 0) words.refuse("a second Triangles section");
      columns = 4;
      read_rows(words, "triangles", 3, mesh.rest.rows(), read.triangle_lines,
                [&](Eigen::Index i, Eigen::Index count, const auto& corner, int) {
                  if (i == 0) read.triangles.resize(count, 3);
                  read.triangles.row(i) << corner[0], corner[1], corner[2];
                });
    } else {
      columns = skip_section(words, section);
    }
  }
}

void check_triangles(const Sections& read, const std::string& name) {
  std::vector<std::pair<std::array<std::int32_t, 3>, std::size_t>> keys;
  const double edge = bounds_of(read.raw.mesh.rest).diagonal();
  for (Eigen::Index t = 0; t < read.triangles.rows(); ++t) {
    const auto row = static_cast<std::size_t>(t);
    const auto corner = [&](int k) -> Vec3 { return read.raw.mesh.rest.row(read.triangles(t, k)); };
    if (!((corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() > 1e-14 * edge * edge))
      throw InputError({Problem{{name, read.triangle_lines[row]}, "the triangle has no area"}});
    std::array<std::int32_t, 3> key{read.triangles(t, 0), read.triangles(t, 1), read.triangles(t, 2)};
    std::sort(key.begin(), key.end());
    keys.emplace_back(key, row);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first != keys[i - 1].first) continue;
    throw InputError(
        {Problem{{name, read.triangle_lines[keys[i].second]},
                 fmt::format("the triangle repeats the one at line {}", read.triangle_lines[keys[i - 1].second])}});
  }
}

}  // namespace

RawMesh read_medit(std::string text, const std::string& name) {
  MeshWords words(std::move(text), name);
  Sections read = read_sections(words, Wanted::tetrahedra);
  if (read.raw.mesh.rest.rows() == 0 || read.raw.mesh.tets.rows() == 0)
    words.refuse("the file has no Vertices or no Tetrahedra");
  return std::move(read.raw);
}

TriMesh read_surface(const std::filesystem::path& path) {
  const std::string name = path.string();
  MeshWords words(mesh_text(path), name);
  const Sections read = read_sections(words, Wanted::triangles);
  if (read.triangles.rows() == 0) words.refuse("the file has no Triangles");
  check_triangles(read, name);
  TriMesh surface;
  surface.triangles = read.triangles;
  std::vector<std::int32_t> compact(static_cast<std::size_t>(read.raw.mesh.rest.rows()), -1), used;
  for (std::int32_t& v : surface.triangles.reshaped()) {
    std::int32_t& place = compact[static_cast<std::size_t>(v)];
    if (place < 0) {
      place = static_cast<std::int32_t>(used.size());
      used.push_back(v);
    }
    v = place;
  }
  surface.points.resize(static_cast<Eigen::Index>(used.size()), 3);
  for (std::size_t i = 0; i < used.size(); ++i)
    surface.points.row(static_cast<Eigen::Index>(i)) = read.raw.mesh.rest.row(used[i]);
  return surface;
}

std::string medit_text(const TetMesh& mesh) {
  std::string text = "MeshVersionFormatted 2\nDimension 3\n";
  text += fmt::format("Vertices\n{}\n", mesh.rest.rows());
  for (Eigen::Index v = 0; v < mesh.rest.rows(); ++v) {
    text += fmt::format("{:.17g} {:.17g} {:.17g} 0\n", mesh.rest(v, 0), mesh.rest(v, 1), mesh.rest(v, 2));
  }
  const Triangles faces = boundary_faces(mesh.tets);
  text += fmt::format("Triangles\n{}\n", faces.rows());
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    text += fmt::format("{} {} {} 0\n", faces(f, 0) + 1, faces(f, 1) + 1, faces(f, 2) + 1);
  text += fmt::format("Tetrahedra\n{}\n", mesh.tets.rows());
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    text += fmt::format("{} {} {} {} {}\n", mesh.tets(e, 0) + 1, mesh.tets(e, 1) + 1, mesh.tets(e, 2) + 1,
                        mesh.tets(e, 3) + 1, mesh.regions.empty() ? 0 : mesh.regions[static_cast<std::size_t>(e)]);
  }
  return text + "End\n";
}

}  // namespace supple
