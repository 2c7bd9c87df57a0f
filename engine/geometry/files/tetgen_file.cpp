// Implements TetGen's pair of files of mesh_formats.h: wias-berlin.de/software/tetgen/fformats.html. Numbers of points
// begin at 0 or 1; of elements with ten nodes the corners are used.
#include <array>
#include <unordered_map>

#include "geometry/files/mesh_formats.h"
#include "geometry/files/mesh_words.h"

namespace supple {
namespace {

using VertexOf = std::unordered_map<long long, std::int32_t>;

VertexOf read_nodes(MeshWords& words, Positions& rest) {
  const Eigen::Index count = words.count("points", 8);
  const int dimension = words.number<int>("the dimension");
  if (dimension != 3) words.refuse(fmt::format("the dimension must be 3, not {}", dimension));
  words.skip_numbers("the number of attributes or markers");
  VertexOf vertex_of;
  rest.resize(count, 3);
  for (Eigen::Index v = 0; v < count; ++v, words.end_row()) {
    const auto number = words.number<long long>("a point's number");
    if (!vertex_of.emplace(number, std::int32_t(v)).second) words.refuse(fmt::format("point {} stands twice", number));
    for (int k = 0; k < 3; ++k) rest(v, k) = words.number<double>("a coordinate");
    words.skip_numbers("an attribute or marker of a point");
  }
  words.refuse_further_rows(0);
  return vertex_of;
}

void read_elements(MeshWords& words, const VertexOf& vertex_of, RawMesh& raw) {
  const Eigen::Index count = words.count("elements", 10);
  const int nodes = words.number<int>("the number of an element's nodes");
  if (nodes != 4 && nodes != 10) words.refuse(fmt::format("elements have 4 or 10 nodes, not {}", nodes));
  const int attributes = words.number<int>("the number of attributes");
  if (nodes == 10) raw.notes.emplace_back("of elements of the second order only the corners are used");
  raw.mesh.tets.resize(count, 4);
  for (Eigen::Index e = 0; e < count; ++e, words.end_row()) {
    (void)words.number<long long>("an element's number");
    for (int k = 0; k < nodes; ++k) {
      const auto number = words.number<long long>("a point of an element");
      const auto known = vertex_of.find(number);
      if (known == vertex_of.end()) words.refuse(fmt::format("point {} does not exist", number));
      if (k < 4) raw.mesh.tets(e, k) = known->second;
    }
    raw.lines.push_back(words.line());
    double region = 0;
    if (attributes > 0) region = words.number<double>("an element's attribute");
    if (!(region >= 0 && region <= double(largest_reference)) || region != std::floor(region))
      words.refuse(fmt::format("attribute {} is no whole number from 0 to {}", region, largest_reference));
    raw.mesh.regions.push_back(int(region));
    words.skip_numbers("an attribute of an element");
  }
  words.refuse_further_rows(0);
}

}  // namespace

RawMesh read_tetgen(std::string nodes, const std::string& nodes_name, std::string elements,
                    const std::string& elements_name) {
  RawMesh raw;
  MeshWords points(std::move(nodes), nodes_name), tets(std::move(elements), elements_name);
  const VertexOf vertex_of = read_nodes(points, raw.mesh.rest);
  read_elements(tets, vertex_of, raw);
  if (raw.mesh.rest.rows() == 0) points.refuse("the file has no points");
  if (raw.mesh.tets.rows() == 0) tets.refuse("the file has no elements");
  return raw;
}

std::string tetgen_nodes(const TetMesh& mesh) {
  std::string text = fmt::format("{} 3 0 0\n", mesh.rest.rows());
  for (Eigen::Index v = 0; v < mesh.rest.rows(); ++v)
    text += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", v + 1, mesh.rest(v, 0), mesh.rest(v, 1), mesh.rest(v, 2));
  return text;
}

// Returns the text of the file of elements, each with its last two corners exchanged. TetGen orients elements the other
// way round: seen from the fourth corner, the first three run clockwise.
std::string tetgen_elements(const TetMesh& mesh) {
  std::string text = fmt::format("{} 4 1\n", mesh.tets.rows());
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    text += fmt::format("{} {} {} {} {} {}\n", e + 1, mesh.tets(e, 0) + 1, mesh.tets(e, 1) + 1, mesh.tets(e, 3) + 1,
                        mesh.tets(e, 2) + 1, mesh.regions.empty() ? 0 : mesh.regions[std::size_t(e)]);
  }
  return text;
}

}  // namespace supple
