#include "geometry/skins/skin_limit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/skins/skin_graph.h"

namespace supple {

double SkinLimit::largest_stretch(const Positions& skin) const {
  double most = 0;
  for (const Edge& edge : edges) {
    const double now = (skin.row(edge.from_vertex) - skin.row(edge.to_vertex)).squaredNorm();
    const double rest = edge.length * edge.length;
    if (now > most * rest) most = now / rest;
  }
  return std::sqrt(most);
}

void SkinLimit::apply(double factor, Positions& skin) const {
  constexpr int most_rounds = 200, patience = 50;
  constexpr double enough = 1 + 1e-3;
  std::vector<Vec3> at(movable.size()), sum(movable.size(), Vec3::Zero());
  for (std::size_t node = 0; node < at.size(); ++node) at[node] = skin.row(copies[std::size_t(begin[node])]);
  std::vector<int> count(at.size(), 0);  // of the edges in `sum`
  std::vector<char> may_move = movable, has_moved(at.size(), 0);
  std::vector<const Edge*> too_long;
  for (int round = 0; round < most_rounds; ++round) {
    too_long.clear();
    for (const Edge& edge : edges) {
      const double most = factor * edge.length * enough;
      const auto a = std::size_t(edge.from), b = std::size_t(edge.to);
      if ((at[b] - at[a]).squaredNorm() > most * most) too_long.push_back(&edge);
    }
    if (too_long.empty()) break;
    for (const Edge* edge : too_long) {
      const auto a = std::size_t(edge->from), b = std::size_t(edge->to);
      if (round >= patience || (may_move[a] == 0 && may_move[b] == 0)) may_move[a] = may_move[b] = 1;
    }
    for (const Edge* edge : too_long) {
      const auto a = std::size_t(edge->from), b = std::size_t(edge->to);
      const Vec3 way = at[b] - at[a];
      const Vec3 step = way * ((1 - factor * edge->length / way.norm()) / (int(may_move[a]) + int(may_move[b])));
      for (const auto& [end, sign] : {std::pair(a, 1.0), std::pair(b, -1.0)}) {
        if (may_move[end] == 0) continue;
        sum[end] += sign * step;
        ++count[end];
      }
    }
    for (std::size_t node = 0; node < at.size(); ++node) {
      if (count[node] == 0) continue;
      at[node] += sum[node] / count[node];
      sum[node].setZero();
      count[node] = 0;
      has_moved[node] = 1;
    }
  }
  for (std::size_t node = 0; node < at.size(); ++node) {
    if (has_moved[node] == 0) continue;
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
      if (to > from && edge.length > 0)
        limit.edges.push_back({std::int32_t(from), edge.to, graph.vertex_of[from], graph.vertex_of[to], edge.length});
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
