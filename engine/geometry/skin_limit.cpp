#include "geometry/skin_limit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/skin_graph.h"

namespace supple {

double SkinLimit::largest_stretch(const Positions& skin) const {
  double most = 0;
  for (const Edge& edge : edges) {
    const auto at = [&](std::int32_t node) { return skin.row(copies[std::size_t(begin[std::size_t(node)])]); };
    most = std::max(most, (at(edge.from) - at(edge.to)).squaredNorm() / (edge.length * edge.length));
  }
  return std::sqrt(most);
}

void SkinLimit::apply(double factor, Positions& skin) const {
  constexpr int most_rounds = 200, patience = 50;
  constexpr double enough = 1 + 1e-3;
  std::vector<Vec3> at(movable.size(), Vec3::Zero()), sum(movable.size(), Vec3::Zero());
  for (std::size_t node = 0; node < at.size(); ++node)
    if (begin[node] < begin[node + 1]) at[node] = skin.row(copies[std::size_t(begin[node])]);
  std::vector<int> count(at.size(), 0);  // of the edges in `sum`
  std::vector<char> moves = movable, moved(at.size(), 0);
  std::vector<std::size_t> pulled;  // nodes
  for (int round = 0; round < most_rounds; ++round) {
    for (const Edge& edge : edges) {
      const auto a = std::size_t(edge.from), b = std::size_t(edge.to);
      const Vec3 way = at[b] - at[a];
      const double square = way.squaredNorm(), most = factor * edge.length;
      if (!(square > most * most * enough * enough)) continue;
      if (round >= patience || (moves[a] == 0 && moves[b] == 0)) moves[a] = moves[b] = 1;
      const Vec3 step = way * ((1 - most / std::sqrt(square)) / (int(moves[a]) + int(moves[b])));
      for (const auto& [end, sign] : {std::pair(a, 1.0), std::pair(b, -1.0)}) {
        if (moves[end] == 0) continue;
        if (count[end]++ == 0) pulled.push_back(end);
        sum[end] += sign * step;
      }
    }
    if (pulled.empty()) break;
    for (const std::size_t node : pulled) {
      at[node] += sum[node] / count[node];
      sum[node].setZero();
      count[node] = 0;
      moved[node] = 1;
    }
    pulled.clear();
  }
  for (std::size_t node = 0; node < at.size(); ++node) {
    if (moved[node] == 0) continue;
    for (std::int32_t i = begin[node]; i < begin[node + 1]; ++i) skin.row(copies[std::size_t(i)]) = at[node];
  }
}

std::optional<SkinLimit> skin_limit(const TriMesh& skin, const Embedding& embedding) {
  const auto outside = [&embedding](Eigen::Index vertex) { return embedding.outside(vertex); };
  bool any = false;
  for (Eigen::Index v = 0; v < embedding.points() && !any; ++v) any = outside(v);
  if (!any) return std::nullopt;
  const SkinGraph graph = skin_graph(skin);
  SkinLimit limit;
  const std::size_t nodes = graph.vertex_of.size();
  for (const std::int32_t vertex : graph.vertex_of) limit.movable.push_back(outside(vertex) ? 1 : 0);
  for (std::size_t from = 0; from < nodes; ++from) {
    for (const SkinEdge& edge : graph.edges[from]) {
      const auto to = std::size_t(edge.to);
      if (to > from && edge.length > 0) limit.edges.push_back({std::int32_t(from), edge.to, edge.length});
    }
  }
  limit.begin.assign(nodes + 1, 0);
  for (const std::int32_t node : graph.node_of) ++limit.begin[std::size_t(node) + 1];
  for (std::size_t node = 0; node < nodes; ++node) limit.begin[node + 1] += limit.begin[node];
  limit.copies.resize(graph.node_of.size());
  std::vector<std::int32_t> next(limit.begin.begin(), limit.begin.end() - 1);
  for (std::size_t v = 0; v < graph.node_of.size(); ++v)
    limit.copies[std::size_t(next[std::size_t(graph.node_of[v])]++)] = std::int32_t(v);
  return limit;
}

}  // namespace supple
