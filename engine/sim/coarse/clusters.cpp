#include "sim/coarse/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "sim/model/element_view.h"

namespace supple {
namespace {

constexpr double unreached = std::numeric_limits<double>::infinity();

// Tells whether a distance is less by more than round-off. Of equal distances the first one counts, so a body that is
// turned as a whole has the same clusters.
bool is_clearly_less(double a, double b) { return a < b * (1 - 1e-9); }

// Holds the edges of the tetrahedra around each vertex.
struct EdgeGraph {
  std::vector<std::int32_t> begin, neighbor;  // of vertex v: begin[v] .. begin[v + 1]
  std::vector<double> length;                 // [m]
};

EdgeGraph edges_of(const Model& model) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  for_each_element(model, [&](const ElementView& element) {
    if (element.kind != ElementKind::tetrahedron) return;
    for (const std::int32_t a : element.corner) {
      for (const std::int32_t b : element.corner) {
        if (a != b) pairs.emplace_back(a, b);
      }
    }
  });
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  EdgeGraph graph;
  graph.begin.assign(std::size_t(model.vertices) + 1, 0);
  for (const auto& [from, to] : pairs) {
    ++graph.begin[from + 1];
    graph.neighbor.push_back(to);
    graph.length.push_back((model.rest.row(from) - model.rest.row(to)).norm());
  }
  for (int v = 0; v < model.vertices; ++v) graph.begin[v + 1] += graph.begin[v];
  return graph;
}

// Computes the distances of all vertices from one, along edges (Dijkstra 1959) [m].
std::vector<double> distances_from(const EdgeGraph& graph, std::int32_t start) {
  std::vector<double> distance(graph.begin.size() - 1, unreached);
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
      if (next >= distance[graph.neighbor[e]]) continue;
      distance[graph.neighbor[e]] = next;
      front.emplace(next, graph.neighbor[e]);
    }
  }
  return distance;
}

// Holds the distances from each centre.
using Distances = std::vector<std::vector<double>>;

bool has_tetrahedra(const EdgeGraph& graph, std::int32_t v) { return graph.begin[v] < graph.begin[v + 1]; }

// Returns the vertex with the largest of these distances, which may be infinite; vertices without tetrahedra are left
// out.
std::int32_t furthest_vertex(const EdgeGraph& graph, const std::vector<double>& distance) {
  std::int32_t furthest = -1;
  for (std::int32_t v = 0; v < std::ssize(distance); ++v) {
    if (has_tetrahedra(graph, v) && (furthest < 0 || is_clearly_less(distance[furthest], distance[v]))) furthest = v;
  }
  return furthest;
}

// Takes again and again the vertex that is furthest from all centres (Gonzalez 1985, "Clustering to minimize the
// maximum intercluster distance"), beginning with an end of the body.
std::vector<std::int32_t> spread_centers(const EdgeGraph& graph, int count) {
  std::vector<double> nearest(graph.begin.size() - 1, unreached);
  const std::int32_t any = furthest_vertex(graph, nearest);
  std::vector<double> from_any = distances_from(graph, any);
  std::replace(from_any.begin(), from_any.end(), unreached, -1.0);
  std::vector<std::int32_t> centers;
  std::int32_t next = furthest_vertex(graph, from_any);
  while (std::ssize(centers) < count) {
    centers.push_back(next);
    const std::vector<double> distance = distances_from(graph, next);
    for (std::size_t v = 0; v < nearest.size(); ++v) nearest[v] = std::min(nearest[v], distance[v]);
    next = furthest_vertex(graph, nearest);
    if (nearest[next] == 0) break;
  }
  return centers;
}

Distances all_distances(const EdgeGraph& graph, const std::vector<std::int32_t>& centers) {
  Distances distances;
  for (const std::int32_t center : centers) distances.push_back(distances_from(graph, center));
  return distances;
}

// Moves each centre to the vertex that is nearest to the mean of the vertices nearest to it (Lloyd 1982).
void center_centers(const Model& model, const Distances& distances, std::vector<std::int32_t>& centers) {
  std::vector<std::int32_t> owner(model.vertices, -1);
  std::vector<Vec3> sum(centers.size(), Vec3::Zero());
  std::vector<double> mass(centers.size(), 0.0);
  for (int v = 0; v < model.vertices; ++v) {
    double least = unreached;
    for (std::size_t c = 0; c < centers.size(); ++c) {
      if (!is_clearly_less(distances[c][v], least)) continue;
      least = distances[c][v];
      owner[v] = static_cast<std::int32_t>(c);
    }
    if (owner[v] < 0) continue;
    sum[owner[v]] += model.mass[v] * model.rest.row(v).transpose();
    mass[owner[v]] += model.mass[v];
  }
  std::vector<double> best(centers.size(), unreached);
  for (int v = 0; v < model.vertices; ++v) {
    if (owner[v] < 0) continue;
    const double away = (model.rest.row(v).transpose() - sum[owner[v]] / mass[owner[v]]).norm();
    if (!is_clearly_less(away, best[owner[v]])) continue;
    best[owner[v]] = away;
    centers[owner[v]] = v;
  }
}

void set_weights(const Distances& distances, std::size_t v, Clusters& clusters) {
  constexpr int most = Clusters::most_of_vertex;
  clusters.of[v].fill(0);
  clusters.weight[v].fill(0);
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
    clusters.of[v][k] = near[k].second;
    sum += clusters.weight[v][k] = share * share;
  }
  // Centres that are all at the same distance get no weight by the formula; they then share alike.
  for (int k = 0; k < count; ++k) clusters.weight[v][k] = sum > 0 ? clusters.weight[v][k] / sum : 1.0 / count;
}

}  // namespace

// A body of a thousand vertices whose parts are as thick as they are long has eight clusters. Slender bodies have up to
// four times as many, because a bar bends between its ends. A cluster of fewer than a dozen vertices would hardly
// differ from the first level.
int wanted_clusters(const Model& model) {
  constexpr int vertices_a_cluster = 100, least_vertices_a_cluster = 12, least = 4, most = 12;
  double volume = 0;
  for_each_element(model, [&](const ElementView& element) {
    if (element.kind == ElementKind::tetrahedron) volume += unit_term(element).weight;
  });
  const double slenderness = model.size / std::cbrt(volume);
  const double wanted =
      std::clamp(model.vertices / vertices_a_cluster, least, most) * std::clamp(slenderness / 4, 1.0, 4.0);
  return std::max(1, std::min(static_cast<int>(wanted), model.vertices / least_vertices_a_cluster));
}

Clusters make_clusters(const Model& model, int count) {
  constexpr int rounds_of_centering = 3;
  const EdgeGraph graph = edges_of(model);
  Clusters clusters;
  clusters.center = spread_centers(graph, count);
  Distances distances = all_distances(graph, clusters.center);
  for (int round = 0; round < rounds_of_centering; ++round) {
    center_centers(model, distances, clusters.center);
    distances = all_distances(graph, clusters.center);
  }
  clusters.of.resize(model.vertices);
  clusters.weight.resize(model.vertices);
  for (int v = 0; v < model.vertices; ++v) set_weights(distances, v, clusters);
  return clusters;
}

}  // namespace supple
