#include "geometry/skins/flat_slide.h"

namespace supple {
namespace {

// Tells of each mesh vertex whether its skin vertices lie at one place of the flat cloth, of the pattern and of the
// texture.
std::vector<char> at_one_place(const Skin& skin, const std::vector<std::int32_t>& vertex_of, Eigen::Index vertices) {
  std::vector<char> one(std::size_t(vertices), 1);
  std::vector<std::int32_t> first(std::size_t(vertices), -1);
  const auto alike = [&skin](std::size_t a, std::size_t b) {
    return (skin.square.empty() || skin.square[a] == skin.square[b]) &&
           (skin.flat.empty() || skin.flat[a] == skin.flat[b]) &&
           (skin.color.empty() || (skin.color[a].texture == skin.color[b].texture &&
                                   skin.color[a].u == skin.color[b].u && skin.color[a].v == skin.color[b].v));
  };
  for (std::size_t v = 0; v < vertex_of.size(); ++v) {
    std::int32_t& known = first[std::size_t(vertex_of[v])];
    if (known < 0) known = static_cast<std::int32_t>(v);
    if (!alike(v, std::size_t(known))) one[std::size_t(vertex_of[v])] = 0;
  }
  return one;
}

// Holds the places of a vertex on the flat cloth, in the pattern and in the texture.
using FlatRow = Eigen::Matrix<double, 1, 7>;

FlatRow flat_row(const Skin& skin, std::size_t v) {
  FlatRow row = FlatRow::Zero();
  for (int k = 0; k < 2 && !skin.square.empty(); ++k) row[k] = skin.square[v][std::size_t(k)];
  for (int k = 0; k < 3 && !skin.flat.empty(); ++k) row[2 + k] = skin.flat[v][std::size_t(k)];
  if (!skin.color.empty()) row.tail<2>() << skin.color[v].u, skin.color[v].v;
  return row;
}

void set_flat_row(const FlatRow& row, std::size_t v, Skin& skin) {
  for (int k = 0; k < 2 && !skin.square.empty(); ++k) skin.square[v][std::size_t(k)] = static_cast<float>(row[k]);
  for (int k = 0; k < 3 && !skin.flat.empty(); ++k) skin.flat[v][std::size_t(k)] = static_cast<float>(row[2 + k]);
  if (skin.color.empty()) return;
  skin.color[v].u = static_cast<float>(row[5]);
  skin.color[v].v = static_cast<float>(row[6]);
}

}  // namespace

void slide_on_flat(const SurfaceWeights& weights, const std::vector<std::int32_t>& vertex_of, Eigen::Index vertices,
                   Skin& skin) {
  const std::vector<char> single = at_one_place(skin, vertex_of, vertices);
  std::vector<FlatRow> at(single.size(), FlatRow::Zero());
  for (std::size_t v = 0; v < vertex_of.size(); ++v) at[std::size_t(vertex_of[v])] = flat_row(skin, v);
  const auto textured = [&skin](std::size_t v) { return skin.color.empty() ? -1 : skin.color[v].texture; };
  std::vector<std::int32_t> texture(single.size(), -1);
  for (std::size_t v = 0; v < vertex_of.size(); ++v) texture[std::size_t(vertex_of[v])] = textured(v);
  for (std::size_t row = 0; row < std::size_t(weights.rows()); ++row) {
    FlatRow sum = FlatRow::Zero();
    bool all = true;
    for (std::int32_t i = weights.begin[row]; i < weights.begin[row + 1]; ++i) {
      const auto vertex = std::size_t(weights.vertex[std::size_t(i)]);
      all = all && single[vertex] != 0 && texture[vertex] == textured(row);
      sum += weights.weight[std::size_t(i)] * at[vertex];
    }
    if (all) set_flat_row(sum, row, skin);
  }
}

}  // namespace supple
