#include "geometry/skins/skin_graph.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>

namespace supple {
namespace {

void name_nodes(const Positions& points, SkinGraph& graph) {
  std::vector<std::int32_t> order(std::size_t(points.rows()));
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](std::int32_t v) { return std::tuple(points(v, 0), points(v, 1), points(v, 2)); };
  std::ranges::sort(order, [&](std::int32_t a, std::int32_t b) {
    return std::tuple_cat(place(a), std::tuple(a)) < std::tuple_cat(place(b), std::tuple(b));
  });
  // The first vertex at a place gives the node its number, so that nodes follow each other as vertices do.
  std::vector<std::int32_t> first(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && place(order[i]) == place(order[i - 1]);
    first[std::size_t(order[i])] = same ? first[std::size_t(order[i - 1])] : order[i];
  }
  graph.node_of.resize(first.size());
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (first[v] == static_cast<std::int32_t>(v)) {
      graph.node_of[v] = static_cast<std::int32_t>(graph.vertex_of.size());
      graph.vertex_of.push_back(static_cast<std::int32_t>(v));
    } else {
      graph.node_of[v] = graph.node_of[std::size_t(first[v])];
    }
  }
}

}  // namespace

SkinGraph skin_graph(const TriMesh& skin) {
  SkinGraph graph;
  name_nodes(skin.points, graph);
  const auto nodes = static_cast<Eigen::Index>(graph.vertex_of.size());
  graph.place.resize(nodes, 3);
  graph.normal = Positions::Zero(nodes, 3);
  graph.edges.resize(std::size_t(nodes));
  for (Eigen::Index n = 0; n < nodes; ++n) graph.place.row(n) = skin.points.row(graph.vertex_of[std::size_t(n)]);
  for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
    std::int32_t corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = graph.node_of[std::size_t(skin.triangles(t, k))];
    const auto side = [&](int k) -> Vec3 { return graph.place.row(corner[k]) - graph.place.row(corner[0]); };
    const Vec3 area = side(1).cross(side(2));
    for (int k = 0; k < 3; ++k) {
      graph.normal.row(corner[k]) += area.transpose();
      const std::int32_t from = corner[k], to = corner[(k + 1) % 3];
      if (from == to) continue;
      const double length = (graph.place.row(from) - graph.place.row(to)).norm();
      graph.edges[std::size_t(from)].push_back({to, length});
      graph.edges[std::size_t(to)].push_back({from, length});
    }
  }
  graph.normal.rowwise().normalize();
  for (std::vector<SkinEdge>& edges : graph.edges) {
    std::ranges::sort(edges, {}, &SkinEdge::to);
    const auto same = [](const SkinEdge& a, const SkinEdge& b) { return a.to == b.to; };
    edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
  }
  return graph;
}

}  // namespace supple
