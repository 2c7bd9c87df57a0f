#include "geometry/skins/outlying_skin.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <span>
#include <tuple>

#include "geometry/meshes/boundary_walk.h"
#include "geometry/skins/skin_graph.h"
#include "geometry/skins/skin_stretch.h"

namespace supple {
namespace {

// A point this close to the boundary, in edges of the boundary, may start a walk of its own, as one in an element does.
constexpr double near_boundary = 0.25;
constexpr double least_share = 1e-3;

// A skin that lies this much deeper in the solid, in edges of the boundary, belongs there whatever its side.
constexpr double deep = 0.75;

// Shares of points outside are averaged over at least this length, in edges of the mesh. Without it the skin has the
// kinks of the elements where it comes close to them, at their vertices: spikes in stripes of colour. With 0.15 they
// are still seen. On a ball of 100 vertices, a vertex that moves alone takes the skin along by 0.78 of its way; with
// a least length of 0.4, by 0.70; without one, by all of it.
constexpr double least_reach = 0.3;

// Tells which vertices of a mesh share an element.
struct MeshLinks {
  explicit MeshLinks(const TetMesh& mesh) : beside(std::size_t(mesh.rest.rows())), mean(mean_edge(mesh)) {
    for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
      for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < 4; ++j) beside[std::size_t(mesh.tets(e, k))].push_back(mesh.tets(e, j));
      }
    }
    for (std::vector<std::int32_t>& list : beside) {
      std::ranges::sort(list);
      list.erase(std::unique(list.begin(), list.end()), list.end());
    }
  }

  bool share_element(std::int32_t a, std::int32_t b) const {
    return std::ranges::binary_search(beside[std::size_t(a)], b);
  }

  // Tells whether carriers that count most for the ends of a skin's edge belong to parts that are near but not joined:
  // the edge is short, and they share no element.
  bool gap(const SkinEdge& edge, std::int32_t some, std::int32_t other) const {
    constexpr double short_edge = 0.7;  // of the mean edge
    return edge.length <= short_edge * mean && !share_element(some, other);
  }

  std::vector<std::vector<std::int32_t>> beside;  // by vertex, ascending; each is beside itself
  double mean;                                    // mean length of the mesh's edges [m]
};

// Finds the boundary point that each outside node of the skin follows.
class Feet {
 public:
  Feet(const SkinGraph& graph, const TetMesh& mesh, const Located& located)
      : graph_(graph),
        located_(located),
        links_(mesh),
        walk_(mesh),
        inside_(graph.edges.size()),
        foot_(graph.edges.size()),
        path_(graph.edges.size(), -1) {
    find_inside();
    start();
    spread();
    start_islands();
    join_strays();
  }

  const MeshLinks& links() const { return links_; }
  // Tells whether an edge of the skin leads to a part of the mesh that is near but not joined.
  bool gap(std::size_t node, const SkinEdge& edge) const {
    return links_.gap(edge, leader(node), leader(std::size_t(edge.to)));
  }

  const BoundaryPoint& foot(std::size_t node) const { return foot_[node]; }
  const Triangles& faces() const { return walk_.faces(); }
  bool inside(std::size_t node) const { return inside_[node] != 0; }

 private:
  using Arrival = std::tuple<double, std::int32_t, std::int32_t>;  // length of the path, node, the node before

  std::span<const std::int32_t> corners(std::size_t node) const {
    return {located_.corners.row(graph_.vertex_of[node]).data(), 4};
  }
  Vec3 place(std::size_t node) const { return graph_.place.row(Eigen::Index(node)); }
  BoundaryPoint own_foot(std::size_t node) const { return walk_.from(corners(node), place(node)); }

  bool same_side(std::size_t node, const BoundaryPoint& foot) const {
    return graph_.normal.row(Eigen::Index(node)).dot(walk_.normal(foot.face)) > 0;
  }

  // Finds the points that belong to the elements in which they lie. One that lies in an element, and not deep, under a
  // boundary that faces the other way belongs to another part: where two limbs are near each other, the elements of one
  // can reach through the skin of the other.
  void find_inside() {
    for (std::size_t n = 0; n < foot_.size(); ++n) {
      if (located_.inside[std::size_t(graph_.vertex_of[n])] == 0) continue;
      const BoundaryPoint above = own_foot(n);
      inside_[n] = above.face < 0 || same_side(n, above) || above.distance > deep * walk_.mean_edge(above.face);
    }
  }

  void start() {
    for (std::size_t n = 0; n < foot_.size(); ++n) {
      if (inside(n)) {
        reach(n, 0);
        continue;
      }
      const BoundaryPoint found = own_foot(n);
      if (found.face < 0 || found.distance > near_boundary * walk_.mean_edge(found.face)) continue;
      if (!same_side(n, found)) continue;
      foot_[n] = found;
      reach(n, 0);
    }
  }

  void reach(std::size_t node, double path) {
    path_[node] = path;
    for (const SkinEdge& edge : graph_.edges[node]) {
      if (path_[std::size_t(edge.to)] < 0) arrivals_.emplace(path + edge.length, edge.to, std::int32_t(node));
    }
  }

  void spread() {
    while (!arrivals_.empty()) {
      const auto [path, node, before] = arrivals_.top();
      arrivals_.pop();
      const auto n = std::size_t(node), from = std::size_t(before);
      if (path_[n] >= 0) continue;
      const std::int32_t face = foot_[from].face;
      foot_[n] =
          face < 0 ? walk_.from(corners(from), place(n)) : walk_.from({walk_.faces().row(face).data(), 3}, place(n));
      reach(n, path);
    }
  }

  // Starts a walk in each part of the skin that meets the solid nowhere, from its vertex that is closest to the
  // boundary.
  void start_islands() {
    std::vector<std::pair<double, std::size_t>> left;
    for (std::size_t n = 0; n < foot_.size(); ++n) {
      if (path_[n] < 0) left.emplace_back(own_foot(n).distance, n);
    }
    std::ranges::sort(left);
    for (const auto& [distance, n] : left) {
      if (path_[n] >= 0) continue;
      foot_[n] = own_foot(n);
      reach(n, 0);
      spread();
    }
  }

  // Returns the mesh vertex that counts most for a node.
  std::int32_t leader(std::size_t node) const {
    int most = 0;
    if (foot_[node].face >= 0) {
      foot_[node].weights.maxCoeff(&most);
      return walk_.faces()(foot_[node].face, most);
    }
    located_.weights.row(graph_.vertex_of[node]).maxCoeff(&most);
    return corners(node)[std::size_t(most)];
  }

  // Lists the nodes of each patch, which edges without a gap join, the smallest patch first.
  std::vector<std::vector<std::size_t>> patches() const {
    std::vector<std::vector<std::size_t>> result;
    std::vector<char> seen(foot_.size(), 0);
    for (std::size_t first = 0; first < seen.size(); ++first) {
      if (seen[first] != 0) continue;
      std::vector<std::size_t> patch = {first};
      seen[first] = 1;
      for (std::size_t i = 0; i < patch.size(); ++i) {
        for (const SkinEdge& edge : graph_.edges[patch[i]]) {
          const auto to = std::size_t(edge.to);
          if (seen[to] != 0 || gap(patch[i], edge)) continue;
          seen[to] = 1;
          patch.push_back(to);
        }
      }
      result.push_back(std::move(patch));
    }
    std::ranges::stable_sort(result, {}, &std::vector<std::size_t>::size);
    return result;
  }

  // Lets each patch of the skin that lies in the elements of a part that is near but not joined follow the skin around
  // it instead, where the boundary that it then follows is no further away than `deep` of its edges.
  void join_strays() {
    std::vector<std::vector<std::size_t>> all = patches();
    std::vector<std::size_t> size(foot_.size());
    for (const std::vector<std::size_t>& patch : all) {
      for (const std::size_t n : patch) size[n] = patch.size();
    }
    for (const std::vector<std::size_t>& patch : all) join(patch, size);
  }

  void join(const std::vector<std::size_t>& patch, std::vector<std::size_t>& size) {
    struct Before {
      BoundaryPoint foot;
      double path;
      char inside;
    };
    std::vector<Before> before;
    std::size_t joined = 0;  // nodes of the largest patch around
    for (const std::size_t n : patch) {
      before.push_back({foot_[n], path_[n], inside_[n]});
      for (const SkinEdge& edge : graph_.edges[n]) {
        if (gap(n, edge)) joined = std::max(joined, size[std::size_t(edge.to)]);
      }
    }
    if (joined <= patch.size()) return;
    for (const std::size_t n : patch) {
      foot_[n] = {};
      path_[n] = -1;
      inside_[n] = 0;
    }
    for (const std::size_t n : patch) {
      for (const SkinEdge& edge : graph_.edges[n]) {
        const auto to = std::size_t(edge.to);
        if (path_[to] >= 0 && size[to] > patch.size())
          arrivals_.emplace(path_[to] + edge.length, std::int32_t(n), edge.to);
      }
    }
    spread();
    const bool near = std::ranges::all_of(patch, [this](std::size_t n) {
      return foot_[n].face >= 0 && foot_[n].distance <= deep * walk_.mean_edge(foot_[n].face);
    });
    for (std::size_t i = 0; i < patch.size(); ++i) {
      if (near) {
        size[patch[i]] += joined;
      } else {
        foot_[patch[i]] = before[i].foot;
        path_[patch[i]] = before[i].path;
        inside_[patch[i]] = before[i].inside;
      }
    }
  }

  const SkinGraph& graph_;
  const Located& located_;
  MeshLinks links_;
  BoundaryWalk walk_;
  std::vector<char> inside_;         // by node: whether it belongs to the element in which it lies
  std::vector<BoundaryPoint> foot_;  // by node; inside: none
  std::vector<double> path_;         // by node; below 0: not reached yet
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> arrivals_;
};

// Averages shares over neighbouring nodes.
class Blend {
 public:
  Blend(const SkinGraph& graph, const Feet& feet, const Located& located, const TetMesh& mesh)
      : graph_(graph), shares_(graph.edges.size()), sum_(std::size_t(mesh.rest.rows()), 0) {
    for (std::size_t n = 0; n < shares_.size(); ++n) {
      shares_[n] = first_shares(feet.foot(n), graph.vertex_of[n], feet, located);
      mean_.push_back(feet.foot(n).face < 0 ? Vec3(graph.place.row(Eigen::Index(n))) : feet.foot(n).point);
    }
    find_reach(feet);
    const int rounds = choose_rates();
    for (int round = 0; round < rounds; ++round) average();
  }

  const std::vector<Carrier>& shares(std::size_t node) const { return shares_[node]; }
  bool changed(std::size_t node) const { return rate_[node] > 0; }

 private:
  // Returns the shares before they are averaged. foot: none where the skin vertex lies in an element.
  static std::vector<Carrier> first_shares(const BoundaryPoint& foot, Eigen::Index skin_vertex, const Feet& feet,
                                           const Located& located) {
    std::vector<Carrier> shares;
    for (int k = 0; k < (foot.face < 0 ? 4 : 3); ++k) {
      const std::int32_t vertex = foot.face < 0 ? located.corners(skin_vertex, k) : feet.faces()(foot.face, k);
      const double share = foot.face < 0 ? located.weights(skin_vertex, k) : foot.weights[k];
      if (share > 0) shares.push_back({vertex, share});
    }
    std::ranges::sort(shares, {}, &Carrier::vertex);
    return shares;
  }

  // Returns by how much the mean of the carriers jumps from a node to a neighbour, beyond 1.5 lengths of the edge [m].
  // Where a short edge leads to carriers that share no element, these are of two parts that are near but not joined,
  // and count as at least two edges of the mesh apart.
  double jump(std::size_t node, const SkinEdge& edge, const Feet& feet) const {
    const auto other = std::size_t(edge.to);
    const double apart = (mean_[node] - mean_[other]).norm() - 1.5 * edge.length;
    return feet.gap(node, edge) ? std::max(apart, 2 * feet.links().mean) : apart;
  }

  // Finds over which length shares are averaged around each node [m]. For a point outside it is the distance from the
  // boundary, but no less than least_reach. At a jump it is no less than the jump. From a point to a neighbour outside
  // it falls by no more than the way between them. Shares of points inside change at jumps alone.
  void find_reach(const Feet& feet) {
    reach_.assign(shares_.size(), 0);
    std::priority_queue<std::pair<double, std::int32_t>> queue;
    for (std::size_t n = 0; n < reach_.size(); ++n) {
      if (!feet.inside(n)) reach_[n] = std::max(feet.foot(n).distance, least_reach * feet.links().mean);
      for (const SkinEdge& edge : graph_.edges[n]) reach_[n] = std::max(reach_[n], jump(n, edge, feet));
      if (reach_[n] > 0) queue.emplace(reach_[n], std::int32_t(n));
    }
    while (!queue.empty()) {
      const auto [reach, node] = queue.top();
      queue.pop();
      if (reach < reach_[std::size_t(node)]) continue;
      for (const SkinEdge& edge : graph_.edges[std::size_t(node)]) {
        const auto to = std::size_t(edge.to);
        const double there = reach - edge.length;
        if (feet.inside(to) || there <= reach_[to]) continue;
        reach_[to] = there;
        queue.emplace(there, edge.to);
      }
    }
  }

  // Chooses the rate of averaging at each node, and returns the number of rounds. With the rate a, n rounds move shares
  // by sqrt(n a) edges, as diffusion does.
  int choose_rates() {
    constexpr double largest_rate = 0.5;
    constexpr int most_rounds = 96;
    std::vector<double> steps(reach_.size(), 0);  // squares of reach over edge
    double most = 0;
    for (std::size_t n = 0; n < reach_.size(); ++n) {
      double squares = 0;
      for (const SkinEdge& edge : graph_.edges[n]) squares += edge.length * edge.length;
      if (squares > 0) steps[n] = reach_[n] * reach_[n] * double(graph_.edges[n].size()) / squares;
      most = std::max(most, steps[n]);
    }
    const int rounds = static_cast<int>(std::min<double>(most_rounds, std::ceil(most / largest_rate)));
    rate_.assign(reach_.size(), 0);
    for (std::size_t n = 0; n < reach_.size(); ++n) {
      rate_[n] = rounds == 0 ? 0 : std::min(largest_rate, steps[n] / rounds);
      if (rate_[n] * rounds < 1e-3) rate_[n] = 0;
      if (rate_[n] > 0) moving_.push_back(n);
    }
    return rounds;
  }

  void average() {
    std::vector<std::vector<Carrier>> next(moving_.size());
    for (std::size_t i = 0; i < moving_.size(); ++i) {
      const std::size_t n = moving_[i];
      double total = 0;
      for (const SkinEdge& edge : graph_.edges[n]) total += 1 / edge.length;
      add(shares_[n], 1 - rate_[n]);
      for (const SkinEdge& edge : graph_.edges[n]) add(shares_[std::size_t(edge.to)], rate_[n] / (edge.length * total));
      next[i] = take();
    }
    for (std::size_t i = 0; i < moving_.size(); ++i) shares_[moving_[i]] = std::move(next[i]);
  }

  void add(const std::vector<Carrier>& shares, double part) {
    for (const Carrier& carrier : shares) {
      double& sum = sum_[std::size_t(carrier.vertex)];
      if (sum == 0) touched_.push_back(carrier.vertex);
      sum += part * carrier.share;
    }
  }

  // Returns what was added, without shares up to least_share, and so scaled that the rest sums to 1.
  std::vector<Carrier> take() {
    std::ranges::sort(touched_);
    std::vector<Carrier> result;
    double total = 0;
    for (const std::int32_t vertex : touched_) {
      double& sum = sum_[std::size_t(vertex)];
      if (sum > least_share) {
        result.push_back({vertex, sum});
        total += sum;
      }
      sum = 0;
    }
    for (Carrier& carrier : result) carrier.share /= total;
    touched_.clear();
    return result;
  }

  const SkinGraph& graph_;
  std::vector<std::vector<Carrier>> shares_;  // by node
  std::vector<Vec3> mean_;                    // by node: the mean of its first carriers, at rest [m]
  std::vector<double> reach_, rate_;          // by node
  std::vector<std::size_t> moving_;           // nodes whose shares are averaged
  std::vector<double> sum_;                   // by mesh vertex, zero between uses
  std::vector<std::int32_t> touched_;
};

}  // namespace

std::vector<std::vector<Carrier>> outside_carriers(const TriMesh& skin, const TetMesh& mesh, const Located& located) {
  std::vector<std::vector<Carrier>> result(std::size_t(skin.points.rows()));
  if (mesh.tets.rows() == 0 || std::ranges::all_of(located.inside, [](char inside) { return inside != 0; }))
    return result;
  const SkinGraph graph = skin_graph(skin);
  const Feet feet(graph, mesh, located);
  const Blend blend(graph, feet, located, mesh);
  for (std::size_t v = 0; v < result.size(); ++v) {
    const auto node = std::size_t(graph.node_of[v]);
    if (!feet.inside(node) || blend.changed(node)) result[v] = blend.shares(node);
  }
  return result;
}

}  // namespace supple
