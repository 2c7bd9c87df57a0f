#include "sim/coarse/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "base/error.h"
#include "sim/model/element_view.h"
#include "sim/model/joined_model.h"

namespace supple {
namespace {

constexpr double unreached = std::numeric_limits<double>::infinity();

// Tells whether a distance is less by more than round-off. Of equal distances the first one counts, so a body that is
// turned as a whole has the same clusters.
bool is_clearly_less(double a, double b) { return a < b * (1 - 1e-9); }

// Numbers the vertices of each part by themselves: its free ones first, then those that are held. Code below that works
// on one part uses these numbers.
class PartNumbers {
 public:
  explicit PartNumbers(const Model& model) : place_(model.vertices) {
    for (std::size_t p = 0; p < model.parts.size(); ++p) {
      const Part& part = model.parts[p];
      for (int v = 0; v < part.free + part.held; ++v)
        place_[joined_vertex(part, v)] = {static_cast<std::int32_t>(p), static_cast<std::int32_t>(v)};
    }
  }

  std::size_t part_of(std::int32_t vertex) const { return static_cast<std::size_t>(place_[vertex].part); }
  std::int32_t in_part(std::int32_t vertex) const { return place_[vertex].number; }

 private:
  struct Place {
    std::int32_t part, number;
  };
  std::vector<Place> place_;  // by vertex of the model
};

// Holds a part's vertices and the edges of the elements around each of them.
struct EdgeGraph {
  Positions rest;            // [m]
  std::vector<double> mass;  // [kg]
  // The neighbours of vertex v are those from begin[v] to begin[v + 1] - 1.
  std::vector<std::int32_t> begin, neighbor;
  std::vector<double> length;  // [m]

  int vertices() const { return static_cast<int>(mass.size()); }
};

using EdgeList = std::vector<std::pair<std::int32_t, std::int32_t>>;

// Lists the edges of the tetrahedra or triangles of each part, in both directions.
std::vector<EdgeList> edges_by_part(const Model& model) {
  const PartNumbers numbers(model);
  std::vector<EdgeList> edges(model.parts.size());
  for_each_element(model, [&](const ElementView& element) {
    if (element.kind == ElementKind::spring) return;
    EdgeList& list = edges[numbers.part_of(element.corner[0])];
    for (int a = 0; a < corners_of(element.kind); ++a) {
      for (int b = 0; b < corners_of(element.kind); ++b) {
        if (a != b) list.emplace_back(numbers.in_part(element.corner[a]), numbers.in_part(element.corner[b]));
      }
    }
  });
  return edges;
}

EdgeGraph graph_of(const Model& model, const Part& part, EdgeList edges) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  EdgeGraph graph;
  graph.rest.resize(part.free + part.held, 3);
  for (int v = 0; v < part.free + part.held; ++v) {
    graph.rest.row(v) = model.rest.row(joined_vertex(part, v));
    graph.mass.push_back(model.mass[joined_vertex(part, v)]);
  }
  graph.begin.assign(graph.mass.size() + 1, 0);
  for (const auto& [from, to] : edges) {
    ++graph.begin[from + 1];
    graph.neighbor.push_back(to);
    graph.length.push_back((graph.rest.row(from) - graph.rest.row(to)).norm());
  }
  for (int v = 0; v < graph.vertices(); ++v) graph.begin[v + 1] += graph.begin[v];
  return graph;
}

// Computes the distances from one vertex, along edges, of all vertices that are clearly nearer to it than their limit
// (Dijkstra 1959) [m]; the others are unreached. limits: each vertex's distance from the nearest of some others, or
// infinity. A shortest way to a vertex within its limit leads only over such vertices, because limits differ along an
// edge by no more than its length.
std::vector<double> distances_from(const EdgeGraph& graph, std::int32_t start, const std::vector<double>& limits) {
  std::vector<double> distance(graph.begin.size() - 1, unreached);
  if (!is_clearly_less(0, limits[start])) return distance;
  std::priority_queue<std::pair<double, std::int32_t>, std::vector<std::pair<double, std::int32_t>>, std::greater<>>
      front;
  distance[start] = 0;
  front.emplace(0, start);
  while (!front.empty()) {
    const auto [at, v] = front.top();
    front.pop();
    if (at > distance[v]) continue;
    for (std::int32_t e = graph.begin[v]; e < graph.begin[v + 1]; ++e) {
      const double next = at + graph.length[e];
      const std::int32_t to = graph.neighbor[e];
      if (next >= distance[to] || !is_clearly_less(next, limits[to])) continue;
      distance[to] = next;
      front.emplace(next, to);
    }
  }
  return distance;
}

std::vector<double> without_limits(const EdgeGraph& graph) {
  return std::vector<double>(graph.begin.size() - 1, unreached);
}

// Holds the distances of all vertices from each centre, by centre [m].
using Distances = std::vector<std::vector<double>>;

bool is_joined(const EdgeGraph& graph, std::int32_t v) { return graph.begin[v] < graph.begin[v + 1]; }

// Returns the vertex with the largest of these distances, which may be infinite; vertices without elements are left
// out.
std::int32_t furthest_vertex(const EdgeGraph& graph, const std::vector<double>& distance) {
  std::int32_t furthest = -1;
  for (std::int32_t v = 0; v < std::ssize(distance); ++v) {
    if (is_joined(graph, v) && (furthest < 0 || is_clearly_less(distance[furthest], distance[v]))) furthest = v;
  }
  return furthest;
}

// Takes again and again the vertex that is furthest from all centres (Gonzalez 1985, "Clustering to minimize the
// maximum intercluster distance"), beginning with an end of the body.
std::vector<std::int32_t> spread_centers(const EdgeGraph& graph, int count) {
  std::vector<double> nearest = without_limits(graph);
  const std::int32_t any = furthest_vertex(graph, nearest);
  std::vector<double> from_any = distances_from(graph, any, nearest);
  std::replace(from_any.begin(), from_any.end(), unreached, -1.0);
  std::vector<std::int32_t> centers;
  std::int32_t next = furthest_vertex(graph, from_any);
  while (std::ssize(centers) < count) {
    centers.push_back(next);
    const std::vector<double> distance = distances_from(graph, next, nearest);
    for (std::size_t v = 0; v < nearest.size(); ++v) nearest[v] = std::min(nearest[v], distance[v]);
    next = furthest_vertex(graph, nearest);
    if (nearest[next] == 0) break;
  }
  return centers;
}

Distances all_distances(const EdgeGraph& graph, const std::vector<std::int32_t>& centers) {
  Distances distances;
  for (const std::int32_t center : centers) distances.push_back(distances_from(graph, center, without_limits(graph)));
  return distances;
}

// Moves each centre to that one of the vertices nearest to it which is closest to their centre of mass (Lloyd 1982).
void center_centers(const EdgeGraph& graph, std::vector<std::int32_t>& centers) {
  std::vector<std::int32_t> owner(graph.vertices(), -1);
  std::vector<double> nearest = without_limits(graph);
  for (std::size_t c = 0; c < centers.size(); ++c) {
    const std::vector<double> distance = distances_from(graph, centers[c], nearest);
    for (int v = 0; v < graph.vertices(); ++v) {
      if (distance[v] == unreached) continue;
      nearest[v] = distance[v];
      owner[v] = static_cast<std::int32_t>(c);
    }
  }
  std::vector<Vec3> sum(centers.size(), Vec3::Zero());
  std::vector<double> mass(centers.size(), 0.0);
  for (int v = 0; v < graph.vertices(); ++v) {
    if (owner[v] < 0) continue;
    sum[owner[v]] += graph.mass[v] * graph.rest.row(v).transpose();
    mass[owner[v]] += graph.mass[v];
  }
  std::vector<double> best(centers.size(), unreached);
  for (int v = 0; v < graph.vertices(); ++v) {
    if (owner[v] < 0) continue;
    const double away = (graph.rest.row(v).transpose() - sum[owner[v]] / mass[owner[v]]).norm();
    if (!is_clearly_less(away, best[owner[v]])) continue;
    best[owner[v]] = away;
    centers[owner[v]] = v;
  }
}

// Holds the clusters of a vertex and their weights.
struct VertexWeights {
  std::array<std::int32_t, Clusters::most_of_vertex> of = {};
  std::array<double, Clusters::most_of_vertex> weight = {};
};

// Returns the weights of a vertex, with the clusters in the numbering of the vertex's part.
VertexWeights weights_of(const Distances& distances, std::size_t v) {
  constexpr int most = Clusters::most_of_vertex;
  VertexWeights result;
  std::vector<std::pair<double, std::int32_t>> near;
  double furthest = 0;
  for (std::size_t c = 0; c < distances.size(); ++c) {
    if (distances[c][v] == unreached) continue;
    near.emplace_back(distances[c][v], static_cast<std::int32_t>(c));
    furthest = std::max(furthest, distances[c][v]);
  }
  std::sort(near.begin(), near.end());
  const int count = std::min<int>(most, static_cast<int>(near.size()));
  const bool some_left = static_cast<int>(near.size()) > most;
  const double reach = some_left ? near[most].first : 1.25 * std::max(furthest, 1e-300);
  double sum = 0;
  for (int k = 0; k < count; ++k) {
    const double share = std::max(0.0, 1 - near[k].first / reach);
    result.of[k] = near[k].second;
    sum += result.weight[k] = share * share;
  }
  // Centres that are all at the same distance get no weight by the formula; they then share alike.
  for (int k = 0; k < count; ++k) result.weight[k] = sum > 0 ? result.weight[k] / sum : 1.0 / count;
  return result;
}

// Adds up to `count` clusters of a part that has elements.
void add_clusters(const Part& part, const EdgeGraph& graph, int count, Clusters& clusters) {
  constexpr int rounds_of_centering = 3;
  std::vector<std::int32_t> centers = spread_centers(graph, count);
  for (int round = 0; round < rounds_of_centering; ++round) center_centers(graph, centers);
  const Distances distances = all_distances(graph, centers);
  const std::int32_t first = clusters.count();
  for (const std::int32_t center : centers) clusters.center.push_back(joined_vertex(part, center));
  for (int v = 0; v < graph.vertices(); ++v) {
    const auto [of, weight] = weights_of(distances, std::size_t(v));
    const std::int32_t vertex = joined_vertex(part, v);
    for (int k = 0; k < Clusters::most_of_vertex; ++k) clusters.of[vertex][k] = first + of[k];
    clusters.weight[vertex] = weight;
  }
}

// Holds what the elements of a part have in all.
struct PartSums {
  double volume = 0;  // of tetrahedra [m^3]
  int triangles = 0;
};

std::vector<PartSums> sums_by_part(const Model& model) {
  const PartNumbers numbers(model);
  std::vector<PartSums> sums(model.parts.size());
  for_each_element(model, [&](const ElementView& element) {
    PartSums& part = sums[numbers.part_of(element.corner[0])];
    if (element.kind == ElementKind::tetrahedron) part.volume += unit_term(element).weight;
    if (element.kind == ElementKind::triangle) ++part.triangles;
  });
  return sums;
}

// Returns how many clusters a body has where it moves by itself. A body of a thousand vertices whose limbs are as thick
// as they are long has ten clusters. Slender bodies have up to four times as many, because a bar bends between its
// ends. A cluster of fewer than a dozen vertices would hardly differ from the first level. volume: that of its
// tetrahedra [m^3].
int wanted_alone(const Part& part, double volume) {
  constexpr int vertices_a_cluster = 100, least_vertices_a_cluster = 12, least = 4, most = 12;
  const int vertices = part.free + part.held;
  const double slenderness = part.size / std::cbrt(volume);
  const double wanted = std::clamp(vertices / vertices_a_cluster, least, most) * std::clamp(slenderness / 4, 1.0, 4.0);
  return std::max(1, std::min(static_cast<int>(wanted), vertices / least_vertices_a_cluster));
}

// Returns how many clusters cloth has. A sheet of a metre that swings for 24 frames comes as near to the solved swing
// with 12 as with 48.
int wanted_of_cloth(const Part& part) {
  constexpr int vertices_a_cluster = 24, most = 16;
  return std::clamp((part.free + part.held) / vertices_a_cluster, 1, most);
}

// Lowers the numbers of clusters of several bodies to `most` in all. Each body keeps at least one, and what is left is
// shared out in proportion to what they want beyond that.
void share_out(int most, std::vector<int>& counts) {
  int bodies = 0, more = 0;
  for (const int count : counts) {
    bodies += count > 0 ? 1 : 0;
    more += std::max(0, count - 1);
  }
  const int left = std::max(0, most - bodies);
  if (more <= left) return;
  for (int& count : counts) {
    if (count > 0) count = 1 + static_cast<int>(std::int64_t{count - 1} * left / more);
  }
}

}  // namespace

std::vector<int> wanted_clusters(const Model& model) {
  constexpr int most_of_several_bodies = 32;
  const std::vector<PartSums> sums = sums_by_part(model);
  std::vector<int> counts;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const Part& part = model.parts[p];
    int count = 0;
    if (sums[p].volume > 0) count = wanted_alone(part, sums[p].volume);
    if (sums[p].triangles > 0) count = wanted_of_cloth(part);
    counts.push_back(count);
  }
  if (counts.size() > 1) share_out(most_of_several_bodies, counts);
  return counts;
}

Clusters make_clusters(const Model& model, const std::vector<int>& counts) {
  SUPPLE_CHECK(counts.size(), ==, model.parts.size());
  std::vector<EdgeList> edges = edges_by_part(model);
  Clusters clusters;
  clusters.of.assign(model.vertices, {});
  clusters.weight.assign(model.vertices, {});
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const Part& part = model.parts[p];
    if (counts[p] > 0 && !edges[p].empty())
      add_clusters(part, graph_of(model, part, std::move(edges[p])), counts[p], clusters);
    clusters.first.push_back(clusters.count());
  }
  return clusters;
}

}  // namespace supple
