#include "geometry/mesh_file.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>

#include "base/error.h"
#include "base/read_file.h"

namespace supple {
namespace {

// Splits a text into words and keeps their line numbers; '#' starts a comment.
class Words {
 public:
  Words(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name)) {}

  // Returns the next word, or an empty one at the end.
  std::string_view next() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') ++line_;
      if (c == '#') {
        while (at_ + 1 < text_.size() && text_[at_ + 1] != '\n') ++at_;
      } else if (!is_space(c)) {
        break;
      }
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_space(text_[at_]) && text_[at_] != '#') ++at_;
    return std::string_view(text_).substr(begin, at_ - begin);
  }

  std::size_t bytes_left() const { return text_.size() - at_; }
  int line() const { return line_; }

  [[noreturn]] void refuse(const std::string& message) const { throw InputError({Problem{name_, line_, 0, message}}); }

  template <class Number>
  Number number(std::string_view what) {
    const std::string_view word = next();
    if (word.empty()) refuse(fmt::format("the file ends where {} should stand", what));
    Number value{};
    const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      refuse(fmt::format("'{}' is not {}", word.substr(0, 40), what));
    if constexpr (std::is_floating_point_v<Number>) {
      if (!std::isfinite(value)) refuse(fmt::format("{} is not finite ({})", what, word.substr(0, 40)));
    }
    return value;
  }

  // Reads a section's count and refuses it when the rest of the file could not hold that many rows.
  Eigen::Index count(std::string_view section, std::size_t fewest_bytes_a_row) {
    const auto value = number<long long>(fmt::format("the number of {}", section));
    if (value < 0 || static_cast<unsigned long long>(value) > bytes_left() / fewest_bytes_a_row + 1) {
      refuse(fmt::format("{} {} announced, but the file has room for at most {}", value, section,
                         bytes_left() / fewest_bytes_a_row));
    }
    return static_cast<Eigen::Index>(value);
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

  std::string text_;
  std::string name_;
  std::size_t at_ = 0;
  int line_ = 1;
};

struct Lines {
  std::vector<int> tets, triangles;
};

// Holds a file as it stands; its indices have been checked.
struct Sections {
  MeshFile file;
  Triangles triangles;
  Lines lines;
};

void check_duplicates(const TetMesh& mesh, const Lines& lines, const std::string& name) {
  std::vector<std::pair<std::array<std::int32_t, 4>, Eigen::Index>> keys;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    std::array<std::int32_t, 4> key{mesh.tets(e, 0), mesh.tets(e, 1), mesh.tets(e, 2), mesh.tets(e, 3)};
    std::sort(key.begin(), key.end());
    keys.emplace_back(key, e);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first != keys[i - 1].first) continue;
    throw InputError({Problem{name, lines.tets[static_cast<std::size_t>(keys[i].second)], 0,
                              fmt::format("the element repeats the one at line {}",
                                          lines.tets[static_cast<std::size_t>(keys[i - 1].second)])}});
  }
}

// Flips all elements when all of them are negative; a mixture of orientations is refused.
void orient(MeshFile& file, const Lines& lines, const std::string& name) {
  TetMesh& mesh = file.mesh;
  const double edge = bounds_of(mesh.rest).diagonal();
  Eigen::Index negative = 0, first_negative = -1;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    const double volume = tet_volume(mesh, e);
    const int line = lines.tets[static_cast<std::size_t>(e)];
    // An element below 1e-18 of the box's cube is flat in double coordinates; the flattest sliver in use has 1e-14.
    if (!(std::abs(volume) > 1e-18 * edge * edge * edge))
      throw InputError({Problem{name, line, 0, "the element has no volume"}});
    if (volume < 0) {
      ++negative;
      if (first_negative < 0) first_negative = e;
    }
  }
  if (negative == 0) return;
  if (negative != mesh.tets.rows()) {
    throw InputError(
        {Problem{name, lines.tets[static_cast<std::size_t>(first_negative)], 0,
                 fmt::format("{} of {} elements are turned inside out, the first here; all must be oriented alike",
                             negative, mesh.tets.rows())}});
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

// Reads rows of `columns` vertex indices and a reference, and passes each to row(i, indices, reference).
template <class Row>
void read_rows(Words& words, const char* what, int columns, Eigen::Index vertices, std::vector<int>& lines,
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
  }
}

// Skips a section that is of no use here: rows of integers.
void skip_section(Words& words, std::string_view section) {
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
  for (Eigen::Index i = 0; i < count * known->integers; ++i) (void)words.number<long long>("an index");
}

enum class Wanted { tetrahedra, triangles };

Sections read_sections(Words& words, Wanted wanted) {
  if (words.next() != "MeshVersionFormatted")
    words.refuse("not a MEDIT mesh: it should begin with MeshVersionFormatted");
  const int version = words.number<int>("the version");
  if (version < 1 || version > 4)
    words.refuse(fmt::format("version {} of the format is not known (1 to 4 are)", version));
  Sections read;
  TetMesh& mesh = read.file.mesh;
  for (;;) {
    const std::string_view section = words.next();
    if (section.empty() || section == "End") return read;
    if (section == "Dimension") {
      if (words.number<int>("the dimension") != 3) words.refuse("the dimension must be 3");
    } else if (section == "Vertices") {
      if (mesh.rest.rows() > 0) words.refuse("a second Vertices section");
      const Eigen::Index count = words.count("vertices", 8);
      mesh.rest.resize(count, 3);
      for (Eigen::Index v = 0; v < count; ++v) {
        for (int k = 0; k < 3; ++k) mesh.rest(v, k) = words.number<double>("a coordinate");
        (void)words.number<long long>("a vertex's reference");
      }
    } else if (section == "Tetrahedra" && wanted == Wanted::tetrahedra) {
      if (mesh.tets.rows() > 0) words.refuse("a second Tetrahedra section");
      read_rows(words, "elements", 4, mesh.rest.rows(), read.lines.tets,
                [&](Eigen::Index i, Eigen::Index count, const auto& corner, int reference) {
                  if (i == 0) mesh.tets.resize(count, 4);
                  mesh.tets.row(i) << corner[0], corner[1], corner[2], corner[3];
                  mesh.regions.push_back(reference);
                });
    } else if (section == "Triangles" && wanted == Wanted::triangles) {
      if (read.triangles.rows() > 0) words.refuse("a second Triangles section");
      read_rows(words, "triangles", 3, mesh.rest.rows(), read.lines.triangles,
                [&](Eigen::Index i, Eigen::Index count, const auto& corner, int) {
                  if (i == 0) read.triangles.resize(count, 3);
                  read.triangles.row(i) << corner[0], corner[1], corner[2];
                });
    } else {
      skip_section(words, section);
    }
  }
}

void check_triangles(const Sections& read, const std::string& name) {
  std::vector<std::pair<std::array<std::int32_t, 3>, std::size_t>> keys;
  const double edge = bounds_of(read.file.mesh.rest).diagonal();
  for (Eigen::Index t = 0; t < read.triangles.rows(); ++t) {
    const auto row = static_cast<std::size_t>(t);
    const auto corner = [&](int k) -> Vec3 { return read.file.mesh.rest.row(read.triangles(t, k)); };
    if (!((corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() > 1e-14 * edge * edge))
      throw InputError({Problem{name, read.lines.triangles[row], 0, "the triangle has no area"}});
    std::array<std::int32_t, 3> key{read.triangles(t, 0), read.triangles(t, 1), read.triangles(t, 2)};
    std::sort(key.begin(), key.end());
    keys.emplace_back(key, row);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first != keys[i - 1].first) continue;
    throw InputError(
        {Problem{name, read.lines.triangles[keys[i].second], 0,
                 fmt::format("the triangle repeats the one at line {}", read.lines.triangles[keys[i - 1].second])}});
  }
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& path) {
  const std::string name = path.string();
  Words words(read_file(path), name);
  Sections read = read_sections(words, Wanted::tetrahedra);
  if (read.file.mesh.rest.rows() == 0 || read.file.mesh.tets.rows() == 0)
    words.refuse("the file has no Vertices or no Tetrahedra");
  check_duplicates(read.file.mesh, read.lines, name);
  orient(read.file, read.lines, name);
  drop_unused(read.file);
  return std::move(read.file);
}

TriMesh read_surface(const std::filesystem::path& path) {
  const std::string name = path.string();
  Words words(read_file(path), name);
  const Sections read = read_sections(words, Wanted::triangles);
  if (read.triangles.rows() == 0) words.refuse("the file has no Triangles");
  check_triangles(read, name);
  TriMesh surface;
  surface.triangles = read.triangles;
  std::vector<std::int32_t> compact(static_cast<std::size_t>(read.file.mesh.rest.rows()), -1), used;
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
    surface.points.row(static_cast<Eigen::Index>(i)) = read.file.mesh.rest.row(used[i]);
  return surface;
}

void write_mesh(const std::filesystem::path& path, const TetMesh& mesh) {
  std::ofstream file(path);
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
  text += "End\n";
  file << text << std::flush;
  if (!file) throw RunError(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace supple
