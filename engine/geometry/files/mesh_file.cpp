#include "geometry/files/mesh_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "base/error.h"
#include "base/read_file.h"
#include "geometry/files/mesh_formats.h"

namespace supple {
namespace {

// Says how messages name the elements of a mesh.
struct ElementNames {
  const std::string& mesh;        // its file, or what else it is called
  const std::vector<int>& lines;  // the line of each element; empty where the mesh has none
  int first = 1;                  // the number of the first element

  [[noreturn]] void refuse(Eigen::Index element, const std::string& message) const {
    if (lines.empty()) throw InputError(mesh, fmt::format("element {}: {}", element + first, message));
    throw InputError({Problem{{mesh, lines[static_cast<std::size_t>(element)]}, message}});
  }
};

void check_duplicates(const TetMesh& mesh, const ElementNames& names) {
  std::vector<std::pair<std::array<std::int32_t, 4>, Eigen::Index>> keys;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    std::array<std::int32_t, 4> key{mesh.tets(e, 0), mesh.tets(e, 1), mesh.tets(e, 2), mesh.tets(e, 3)};
    std::sort(key.begin(), key.end());
    keys.emplace_back(key, e);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first != keys[i - 1].first) continue;
    const Eigen::Index first = keys[i - 1].second, second = keys[i].second;
    names.refuse(second, names.lines.empty()
                             ? fmt::format("the element repeats element {}", first + names.first)
                             : fmt::format("the element repeats the one at line {}", names.lines[std::size_t(first)]));
  }
}

// Flips all elements when all of them are negative; a mixture of orientations is refused.
void orient(MeshFile& file, const ElementNames& names) {
  TetMesh& mesh = file.mesh;
  const double edge = bounds_of(mesh.rest).diagonal();
  Eigen::Index negative = 0, first_negative = -1;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    const double volume = tet_volume(mesh, e);
    // An element below 1e-18 of the box's cube is flat in double coordinates; the flattest sliver in use has 1e-14.
    if (!(std::abs(volume) > 1e-18 * edge * edge * edge)) names.refuse(e, "the element has no volume");
    if (volume < 0) {
      ++negative;
      if (first_negative < 0) first_negative = e;
    }
  }
  if (negative == 0) return;
  if (negative != mesh.tets.rows()) {
    names.refuse(first_negative,
                 fmt::format("{} of {} elements are turned inside out, the first here; all must be oriented alike",
                             negative, mesh.tets.rows()));
  }
  mesh.tets.col(2).swap(mesh.tets.col(3));
  file.notes.push_back("all elements were oriented the other way round, and have been turned");
}

void drop_unused(MeshFile& file) {
  std::vector<char> used(static_cast<std::size_t>(file.mesh.rest.rows()), 0);
  for (const std::int32_t v : file.mesh.tets.reshaped()) used[static_cast<std::size_t>(v)] = 1;
  const auto unused = std::count(used.begin(), used.end(), 0);
  if (unused == 0) return;
  file.mesh = submesh(file.mesh, std::vector<char>(static_cast<std::size_t>(file.mesh.tets.rows()), 1));
  file.notes.push_back(fmt::format("{} vertices belong to no element, and have been left out", unused));
}

struct MeshFormat {
  const char* extension;
  RawMesh (*read)(std::string text, const std::string& name);
  std::string (*write)(const TetMesh& mesh);
};

constexpr std::array formats = {MeshFormat{".mesh", read_medit, medit_text}, MeshFormat{".msh", read_gmsh, gmsh_text},
                                MeshFormat{".vtk", read_legacy_vtk, legacy_vtk_text},
                                MeshFormat{".vtu", read_vtu, vtu_text}};

const MeshFormat* format_of(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  const auto* const found =
      std::find_if(formats.begin(), formats.end(), [&](const MeshFormat& f) { return f.extension == extension; });
  return found == formats.end() ? nullptr : found;
}

// Tells whether a file is one of the two that TetGen writes under one name.
bool is_tetgen(const std::filesystem::path& path) { return path.extension() == ".ele" || path.extension() == ".node"; }

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file) throw RunError(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace

std::string mesh_text(const std::filesystem::path& path) {
  std::string text = read_text(path);
  if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
  return text;
}

std::string left_out_note(long long elements) {
  return fmt::format("{} elements are no tetrahedra of the first or second order, and have been left out", elements);
}

bool is_mesh_file(const std::filesystem::path& path) { return format_of(path) != nullptr || is_tetgen(path); }

MeshFile read_mesh(const std::filesystem::path& path) {
  std::string name = path.string();
  RawMesh raw;
  if (is_tetgen(path)) {
    std::filesystem::path nodes = path, elements = path;
    nodes.replace_extension(".node");
    elements.replace_extension(".ele");
    name = elements.string();
    raw = read_tetgen(mesh_text(nodes), nodes.string(), mesh_text(elements), name);
  } else {
    const MeshFormat* format = format_of(path);
    raw = (format != nullptr ? *format : formats.front()).read(mesh_text(path), name);
  }
  MeshFile file{std::move(raw.mesh), std::move(raw.notes)};
  const ElementNames names{name, raw.lines};
  check_duplicates(file.mesh, names);
  orient(file, names);
  drop_unused(file);
  return file;
}

TetMesh checked_mesh(TetMesh mesh, const std::string& name, int first) {
  const std::vector<int> no_lines;
  const ElementNames names{name, no_lines, first};
  const Eigen::Index vertices = mesh.rest.rows();
  if (mesh.tets.rows() == 0) throw InputError(name, "has no elements");
  std::vector<char> used(static_cast<std::size_t>(vertices), 0);
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    for (const std::int32_t v : mesh.tets.row(e)) {
      if (v < 0 || v >= vertices)
        names.refuse(e, fmt::format("vertex {} does not exist; there are {}", v + std::int64_t(first), vertices));
      used[static_cast<std::size_t>(v)] = 1;
    }
  }
  for (Eigen::Index v = 0; v < vertices; ++v) {
    if (!mesh.rest.row(v).allFinite()) throw InputError(name, fmt::format("vertex {} is not finite", v + first));
    if (used[std::size_t(v)] == 0) throw InputError(name, fmt::format("vertex {} belongs to no element", v + first));
  }
  MeshFile file{std::move(mesh), {}};
  check_duplicates(file.mesh, names);
  orient(file, names);
  return std::move(file.mesh);
}

void check_writable(const std::filesystem::path& path) {
  if (is_mesh_file(path)) return;
  const std::string extension = path.extension().string();
  throw InputError(path.string(), fmt::format("{} is no format for tetrahedra here: {}",
                                              extension.empty() ? "none" : extension, mesh_formats));
}

void write_mesh(const std::filesystem::path& path, const TetMesh& mesh) {
  check_writable(path);
  if (!is_tetgen(path)) return write_text(path, format_of(path)->write(mesh));
  std::filesystem::path nodes = path, elements = path;
  write_text(nodes.replace_extension(".node"), tetgen_nodes(mesh));
  write_text(elements.replace_extension(".ele"), tetgen_elements(mesh));
}

}  // namespace supple
