#include "geometry/skins/flat_places.h"

#include <algorithm>
#include <array>
#include <map>
#include <queue>
#include <utility>

namespace supple {
namespace {

using NodePair = std::pair<std::int32_t, std::int32_t>;

// Joins the nodes of a surface, which are its vertices without splits, and tells which edges are open.
struct BorderGraph {
  std::vector<Vec3> place;                            // by node [m]
  std::vector<std::vector<std::int32_t>> neighbours;  // by node
  std::vector<NodePair> border;                       // edges with one triangle
};

BorderGraph border_graph(const Skin& skin, const std::vector<std::int32_t>& node_of) {
  BorderGraph graph;
  const std::size_t nodes = node_of.empty() ? 0 : 1 + std::size_t(*std::ranges::max_element(node_of));
  graph.place.resize(nodes);
  graph.neighbours.resize(nodes);
  for (std::size_t v = 0; v < node_of.size(); ++v)
    graph.place[std::size_t(node_of[v])] = skin.rest.points.row(Eigen::Index(v));
  std::map<NodePair, int> sides;  // of each edge
  for (Eigen::Index t = 0; t < skin.rest.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = node_of[std::size_t(skin.rest.triangles(t, k))],
                         b = node_of[std::size_t(skin.rest.triangles(t, (k + 1) % 3))];
      ++sides[std::minmax(a, b)];
    }
  }
  for (const auto& [edge, count] : sides) {
    graph.neighbours[std::size_t(edge.first)].push_back(edge.second);
    graph.neighbours[std::size_t(edge.second)].push_back(edge.first);
    if (count == 1) graph.border.push_back(edge);
  }
  return graph;
}

double distance_to(const Vec3& point, const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double along = std::clamp((point - from).dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
  return (point - from - along * way).norm();
}

// Returns the distance of each node to the nearest border [m]. Each node learns of a border's edge from a neighbour
// that is nearer to it (Dijkstra 1959), so that the other side of a fold does not count.
std::vector<double> border_distances(const BorderGraph& graph) {
  std::vector<double> distance(graph.place.size(), no_border);
  struct Known {
    double distance;
    std::int32_t node;
    std::size_t edge;
    bool operator<(const Known& other) const {
      return std::pair(-distance, node) < std::pair(-other.distance, other.node);
    }
  };
  std::priority_queue<Known> front;
  const auto tell = [&](std::int32_t node, std::size_t edge) {
    const auto& [from, to] = graph.border[edge];
    const double there =
        distance_to(graph.place[std::size_t(node)], graph.place[std::size_t(from)], graph.place[std::size_t(to)]);
    if (there >= distance[std::size_t(node)]) return;
    distance[std::size_t(node)] = there;
    front.push({there, node, edge});
  };
  for (std::size_t e = 0; e < graph.border.size(); ++e) {
    tell(graph.border[e].first, e);
    tell(graph.border[e].second, e);
  }
  while (!front.empty()) {
    const Known nearest = front.top();
    front.pop();
    if (nearest.distance > distance[std::size_t(nearest.node)]) continue;
    for (const std::int32_t neighbour : graph.neighbours[std::size_t(nearest.node)]) tell(neighbour, nearest.edge);
  }
  return distance;
}

}  // namespace

std::vector<FlatPlace> flat_places(const Skin& skin, const std::vector<std::int32_t>& mesh_vertex, double square) {
  const std::vector<double> border = border_distances(border_graph(skin, mesh_vertex));
  std::vector<FlatPlace> places;
  for (std::size_t v = 0; v < mesh_vertex.size(); ++v) {
    const auto& [u, w] = skin.square[v];
    places.push_back({static_cast<float>(square * u), static_cast<float>(square * w),
                      static_cast<float>(border[std::size_t(mesh_vertex[v])])});
  }
  return places;
}

}  // namespace supple
