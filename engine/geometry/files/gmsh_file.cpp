// Implements Gmsh's MSH format of mesh_formats.h: gmsh.info/doc/texinfo/gmsh.html, "Gmsh file formats". Tetrahedra of
// the first and second order are read, of the latter their corners; all other elements are skipped.
#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

#include "geometry/files/mesh_formats.h"
#include "geometry/files/mesh_words.h"

namespace supple {
namespace {

constexpr int linear_tetrahedron = 4, quadratic_tetrahedron = 11;

struct Gmsh {
  std::vector<Vec3> points;
  std::unordered_map<long long, std::int32_t> vertex_of;  // by the node's tag
  std::vector<std::array<std::int32_t, 4>> tets;
  std::map<long long, int> group_of;  // the first physical group of a volume, by its tag
  RawMesh raw;
  bool quadratic = false;
  long long others = 0;  // elements with a volume that are no such tetrahedra
};

// Counts hexahedra, prisms, pyramids and tetrahedra of higher orders, without which a body has holes.
void count_other(int type, Gmsh& mesh) {
  constexpr std::array volumes = {5, 6, 7, 12, 13, 14, 17, 18, 19, 29, 30, 31, 92, 93};
  mesh.others += std::find(volumes.begin(), volumes.end(), type) != volumes.end() ? 1 : 0;
}

void add_node(MeshWords& words, long long tag, Gmsh& mesh) {
  Vec3 p;
  for (int k = 0; k < 3; ++k) p[k] = words.number<double>("a coordinate");
  if (!mesh.vertex_of.emplace(tag, std::int32_t(mesh.points.size())).second)
    words.refuse(fmt::format("node {} stands twice", tag));
  mesh.points.push_back(p);
}

void add_tetrahedron(MeshWords& words, int type, long long group, Gmsh& mesh) {
  std::array<std::int32_t, 4> corners{};
  for (std::int32_t& corner : corners) {
    const auto tag = words.number<long long>("a node of an element");
    const auto known = mesh.vertex_of.find(tag);
    if (known == mesh.vertex_of.end()) words.refuse(fmt::format("node {} does not exist", tag));
    corner = known->second;
  }
  if (group < 0 || group > largest_reference)
    words.refuse(fmt::format("group {} is outside 0 to {}", group, largest_reference));
  mesh.raw.lines.push_back(words.line());
  if (type == linear_tetrahedron && !words.at_line_end()) words.refuse("more than four nodes of a tetrahedron");
  words.skip_numbers("a node of an element");  // the middles of the edges
  mesh.quadratic |= type == quadratic_tetrahedron;
  mesh.tets.push_back(corners);
  mesh.raw.mesh.regions.push_back(int(group));
}

bool is_tetrahedron(int type) { return type == linear_tetrahedron || type == quadratic_tetrahedron; }

void read_nodes_2(MeshWords& words, Gmsh& mesh) {
  const Eigen::Index count = words.count("nodes", 8);
  for (Eigen::Index i = 0; i < count; ++i, words.end_row()) {
    const auto tag = words.number<long long>("a node's number");
    add_node(words, tag, mesh);
  }
}

void read_elements_2(MeshWords& words, Gmsh& mesh) {
  const Eigen::Index count = words.count("elements", 6);
  for (Eigen::Index i = 0; i < count; ++i, words.end_row()) {
    (void)words.number<long long>("an element's number");
    const int type = words.number<int>("an element's type"),
              tags = words.number<int>("the number of an element's tags");
    if (tags < 0 || tags > 1000) words.refuse(fmt::format("an element with {} tags", tags));
    long long group = 0;
    for (int k = 0; k < tags; ++k) {
      const auto tag = words.number<long long>("an element's tag");
      if (k == 0) group = tag;
    }
    if (is_tetrahedron(type)) {
      add_tetrahedron(words, type, group, mesh);
    } else {
      count_other(type, mesh);
      words.skip_numbers("a node of an element");
    }
  }
}

// Reads the physical groups of volumes. A point has a place, every other entity a box, and each has its groups; what
// bounds an entity is not needed.
void read_entities(MeshWords& words, Gmsh& mesh) {
  std::array<Eigen::Index, 4> counts{};
  for (Eigen::Index& count : counts) count = words.count("entities", 10);
  for (std::size_t dimension = 0; dimension < 4; ++dimension) {
    for (Eigen::Index i = 0; i < counts[dimension]; ++i) {
      const auto tag = words.number<long long>("an entity's tag");
      for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) (void)words.number<double>("a bound of an entity");
      const auto groups = words.number<long long>("the number of an entity's groups");
      if (groups > 0 && dimension == 3) mesh.group_of[tag] = words.number<int>("an entity's group");
      words.skip_line();
    }
  }
}

void read_nodes_4(MeshWords& words, Gmsh& mesh) {
  const auto blocks = words.number<long long>("the number of blocks");
  const Eigen::Index count = words.count("nodes", 8);
  words.skip_line();
  for (long long block = 0; block < blocks; ++block) {
    const auto dimension = words.number<int>("an entity's dimension");
    (void)words.number<long long>("an entity's tag");
    const bool parametric = words.number<int>("whether nodes have parameters") != 0;
    const auto here = words.number<long long>("the number of nodes in a block");
    if (here < 0 || here + std::ssize(mesh.points) > count)
      words.refuse(
          fmt::format("{} nodes announced, but the blocks hold {} or more", count, here + std::ssize(mesh.points)));
    std::vector<long long> tags;
    for (long long i = 0; i < here; ++i) tags.push_back(words.number<long long>("a node's tag"));
    for (const long long tag : tags) {
      add_node(words, tag, mesh);
      for (int k = 0; parametric && k < dimension; ++k) (void)words.number<double>("a parameter");
      words.end_row();
    }
  }
  if (std::ssize(mesh.points) != count)
    words.refuse(fmt::format("{} nodes announced, but the blocks hold {}", count, mesh.points.size()));
}

void read_elements_4(MeshWords& words, Gmsh& mesh) {
  const auto blocks = words.number<long long>("the number of blocks");
  const Eigen::Index count = words.count("elements", 4);
  words.skip_line();
  Eigen::Index sum = 0;
  for (long long block = 0; block < blocks; ++block) {
    (void)words.number<int>("an entity's dimension");
    const auto entity = words.number<long long>("an entity's tag");
    const int type = words.number<int>("an element's type");
    const auto here = words.number<long long>("the number of elements in a block");
    sum += here;
    if (here < 0 || sum > count)
      words.refuse(fmt::format("{} elements announced, but the blocks hold {} or more", count, sum));
    const auto group = mesh.group_of.find(entity);
    for (long long i = 0; i < here; ++i, words.end_row()) {
      (void)words.number<long long>("an element's tag");
      if (is_tetrahedron(type)) {
        add_tetrahedron(words, type, group == mesh.group_of.end() ? 0 : group->second, mesh);
      } else {
        count_other(type, mesh);
        words.skip_numbers("a node of an element");
      }
    }
  }
  if (sum != count) words.refuse(fmt::format("{} elements announced, but the blocks hold {}", count, sum));
}

double read_version(MeshWords& words) {
  if (words.next() != "$MeshFormat") words.refuse("not a Gmsh mesh: it should begin with $MeshFormat");
  const auto version = words.number<double>("the version");
  const bool known = (version >= 2 && version < 3) || (version >= 4.1 && version < 5);
  if (!known) words.refuse(fmt::format("version {} is not read (2.2 and 4.1 are: gmsh -format msh41)", version));
  if (words.number<int>("the file type") != 0)
    words.refuse("binary files are not read (gmsh -save without -bin writes text)");
  words.skip_line();
  return version;
}

void end_section(MeshWords& words, std::string_view section) {
  const std::string end = fmt::format("$End{}", section.substr(1));
  const std::string_view word = words.next();
  if (word != end) words.refuse(fmt::format("'{}' stands where {} should end", word.substr(0, 40), section));
}

void skip_section(MeshWords& words, const std::string& section) {
  const std::string end = fmt::format("$End{}", section.substr(1));
  for (std::string_view word = words.next(); word != end; word = words.next())
    if (word.empty()) words.refuse(fmt::format("the file ends where {} should stand", end));
}

RawMesh finished(MeshWords& words, Gmsh& mesh) {
  if (mesh.points.empty() || mesh.tets.empty()) words.refuse("the file has no $Nodes or no tetrahedra");
  TetMesh& result = mesh.raw.mesh;
  result.rest.resize(std::ssize(mesh.points), 3);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) result.rest.row(Eigen::Index(v)) = mesh.points[v].transpose();
  result.tets.resize(std::ssize(mesh.tets), 4);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    for (int k = 0; k < 4; ++k) result.tets(Eigen::Index(e), k) = mesh.tets[e][std::size_t(k)];
  if (mesh.quadratic) mesh.raw.notes.emplace_back("of elements of the second order only the corners are used");
  if (mesh.others > 0) mesh.raw.notes.push_back(left_out_note(mesh.others));
  return std::move(mesh.raw);
}

}  // namespace

RawMesh read_gmsh(std::string text, const std::string& name) {
  MeshWords words(std::move(text), name);
  const bool blocks = read_version(words) >= 4;
  Gmsh mesh;
  bool in_header = true;
  for (std::string section(words.next()); !section.empty(); section = words.next()) {
    if (section.front() != '$' || (in_header && section != "$EndMeshFormat"))
      words.refuse(fmt::format("'{}' stands where a section should begin", section.substr(0, 40)));
    if (in_header) {
      in_header = false;
    } else if (section == "$Entities" && blocks) {
      read_entities(words, mesh);
      end_section(words, section);
    } else if (section == "$Nodes") {
      if (!mesh.points.empty()) words.refuse("a second $Nodes section");
      blocks ? read_nodes_4(words, mesh) : read_nodes_2(words, mesh);
      words.refuse_further_rows(0);
      end_section(words, section);
    } else if (section == "$Elements") {
      if (!mesh.tets.empty()) words.refuse("a second $Elements section");
      blocks ? read_elements_4(words, mesh) : read_elements_2(words, mesh);
      words.refuse_further_rows(0);
      end_section(words, section);
    } else {
      skip_section(words, section);
    }
  }
  return finished(words, mesh);
}

std::string gmsh_text(const TetMesh& mesh) {
  const auto region = [&](Eigen::Index e) { return mesh.regions.empty() ? 0 : mesh.regions[std::size_t(e)]; };
  std::map<int, std::vector<Eigen::Index>> by_region;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) by_region[region(e)].push_back(e);
  const Bounds box = bounds_of(mesh.rest);
  std::string text = fmt::format("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 {}\n", by_region.size());
  for (const auto& [tag, elements] : by_region) {
    text += fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} ", tag + 1, box.lower.x(), box.lower.y(),
                        box.lower.z(), box.upper.x(), box.upper.y(), box.upper.z());
    text += tag > 0 ? fmt::format("1 {} 0\n", tag) : "0 0\n";  // Gmsh has no group 0
  }
  const int first_entity = by_region.begin()->first + 1;
  const Eigen::Index points = mesh.rest.rows();
  text += fmt::format("$EndEntities\n$Nodes\n1 {} 1 {}\n3 {} 0 {}\n", points, points, first_entity, points);
  for (Eigen::Index v = 0; v < points; ++v) text += fmt::format("{}\n", v + 1);
  for (Eigen::Index v = 0; v < points; ++v)
    text += fmt::format("{:.17g} {:.17g} {:.17g}\n", mesh.rest(v, 0), mesh.rest(v, 1), mesh.rest(v, 2));
  text += fmt::format("$EndNodes\n$Elements\n{} {} 1 {}\n", by_region.size(), mesh.tets.rows(), mesh.tets.rows());
  for (const auto& [tag, elements] : by_region) {
    text += fmt::format("3 {} {} {}\n", tag + 1, linear_tetrahedron, elements.size());
    for (const Eigen::Index e : elements)
      text += fmt::format("{} {} {} {} {}\n", e + 1, mesh.tets(e, 0) + 1, mesh.tets(e, 1) + 1, mesh.tets(e, 2) + 1,
                          mesh.tets(e, 3) + 1);
  }
  return text + "$EndElements\n";
}

}  // namespace supple
