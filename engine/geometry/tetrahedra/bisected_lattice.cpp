#include "geometry/tetrahedra/bisected_lattice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace supple {
namespace {

using TetCorners = std::array<int, 4>;

std::uint64_t edge_key(int a, int b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint32_t>(std::max(a, b));
}

constexpr int pairs[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

class LatticeBuilder {
 public:
  LatticeBuilder(const Eigen::Vector3i& cells, int halvings, const LatticeQuestion& is_too_large)
      : cells_(cells), spacing_(2 << halvings), is_too_large_(is_too_large) {
    corner_.assign((cells + Eigen::Vector3i::Ones()).cast<std::size_t>().prod(), -1);
  }

  // Cuts a cell into twelve elements, two on each of its faces, with its centre as their common corner. Both cells at a
  // face cut it alike.
  void add_cell(const Eigen::Vector3i& cell) {
    const int half = spacing_ / 2;
    const int center = add_site(cell * spacing_ + Eigen::Vector3i::Constant(half));
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        Eigen::Vector3i low = cell;
        low[axis] += side;
        const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3), v = Eigen::Vector3i::Unit((axis + 2) % 3);
        const int from = corner(low), to = corner(low + u + v);
        add({from, to, corner(low + u), center});
        add({from, to, corner(low + v), center});
      }
    }
  }

  void bisect_all() {
    for (bool changed = true; changed;) {
      changed = false;
      const std::size_t count = tets_.size();  // halves that are added meanwhile have their turn in the next round
      for (std::size_t t = 0; t < count; ++t) {
        if (!too_large_[t] && !has_bisected_edge(tets_[t])) continue;
        bisect(t);
        changed = true;
      }
    }
  }

  // Replaces the four elements around the diagonal of a square between two equal cells by the four around the edge that
  // joins the middles of these cells. These are elements of the body-centred cubic lattice, which are rounder.
  void turn_diagonals() {
    std::unordered_map<std::uint64_t, std::vector<std::size_t>> around;
    for (std::size_t t = 0; t < tets_.size(); ++t)
      if (is_half_pyramid(tets_[t])) around[edge_key(tets_[t][0], tets_[t][1])].push_back(t);
    for (std::size_t t = 0; t < tets_.size(); ++t) {
      const auto found = around.find(edge_key(tets_[t][0], tets_[t][1]));
      if (found == around.end() || found->second.size() != 4 || found->second.front() != t) continue;
      turn_diagonal(found->second);
    }
  }

  BisectedLattice result() {
    BisectedLattice lattice;
    lattice.shortest.assign(sites_.size(), std::numeric_limits<double>::max());
    for (const TetCorners& tet : tets_) {
      for (const auto& [i, j] : pairs) {
        const double length = std::sqrt(double(squared_length(tet[std::size_t(i)], tet[std::size_t(j)])));
        for (const int k : {i, j}) {
          double& shortest = lattice.shortest[std::size_t(tet[std::size_t(k)])];
          shortest = std::min(shortest, length);
        }
      }
    }
    lattice.sites = std::move(sites_);
    lattice.tets = std::move(tets_);
    return lattice;
  }

 private:
  const Eigen::Vector3i& site(int s) const { return sites_[std::size_t(s)]; }
  int squared_length(int a, int b) const { return (site(a) - site(b)).squaredNorm(); }

  int add_site(const Eigen::Vector3i& place) {
    sites_.push_back(place);
    return static_cast<int>(sites_.size()) - 1;
  }

  int corner(const Eigen::Vector3i& at) {
    const auto [x, y, z] = std::array{std::size_t(at.x()), std::size_t(at.y()), std::size_t(at.z())};
    int& name = corner_[(z * std::size_t(cells_.y() + 1) + y) * std::size_t(cells_.x() + 1) + x];
    if (name < 0) name = add_site(at * spacing_);
    return name;
  }

  // Puts the ends of the longest edge first; there is only one in the three shapes that are bisected.
  TetCorners longest_first(TetCorners tet) const {
    int longest = 0;
    std::size_t first = 0, second = 1;
    for (const auto& [i, j] : pairs) {
      const int length = squared_length(tet[std::size_t(i)], tet[std::size_t(j)]);
      if (length <= longest) continue;
      longest = length;
      first = std::size_t(i);
      second = std::size_t(j);
    }
    std::swap(tet[0], tet[first]);
    std::swap(tet[1], tet[second]);  // second > first, so that the first swap did not move it
    return tet;
  }

  bool ask(const TetCorners& tet) const {
    const Eigen::Vector3i a = site(tet[1]) - site(tet[0]), b = site(tet[2]) - site(tet[0]),
                          c = site(tet[3]) - site(tet[0]);
    const double sixfold = std::abs(double(a.dot(b.cross(c))));
    Vec3 middle = Vec3::Zero();
    for (const int s : tet) middle += 0.25 * site(s).cast<double>();
    constexpr double smallest = 2;
    const double spacing = std::cbrt(2 * sixfold);
    return spacing > 1.01 * smallest && is_too_large_(middle, spacing);
  }

  void add(const TetCorners& corners) {
    tets_.push_back(longest_first(corners));
    too_large_.push_back(ask(corners));
  }

  bool has_bisected_edge(const TetCorners& tet) const {
    for (const auto& [i, j] : pairs)
      if (middle_of_.count(edge_key(tet[std::size_t(i)], tet[std::size_t(j)])) > 0) return true;
    return false;
  }

  void bisect(std::size_t t) {
    const auto [from, to, c, d] = tets_[t];
    auto [at, is_new] = middle_of_.try_emplace(edge_key(from, to), static_cast<int>(sites_.size()));
    if (is_new) add_site((site(from) + site(to)) / 2);
    const int middle = at->second;
    tets_[t] = longest_first({from, middle, c, d});
    too_large_[t] = ask(tets_[t]);
    add({middle, to, c, d});
  }

  bool is_half_pyramid(const TetCorners& tet) const {
    return 8 * squared_length(tet[0], tet[2]) == 3 * squared_length(tet[0], tet[1]) ||
           8 * squared_length(tet[0], tet[3]) == 3 * squared_length(tet[0], tet[1]);
  }

  void turn_diagonal(const std::vector<std::size_t>& around) {
    const int from = tets_[around[0]][0], to = tets_[around[0]][1], diagonal = squared_length(from, to);
    std::array<int, 2> corners{-1, -1}, centers{-1, -1};
    for (const std::size_t t : around) {
      for (const std::size_t k : {2, 3}) {
        const int s = tets_[t][k];
        auto& ends = 2 * squared_length(from, s) == diagonal ? corners : centers;
        if (ends[0] < 0) ends[0] = s;
        if (ends[0] != s) ends[1] = s;
      }
    }
    const int ring[4] = {from, corners[0], to, corners[1]};
    for (std::size_t k = 0; k < 4; ++k) tets_[around[k]] = {centers[0], centers[1], ring[k], ring[(k + 1) % 4]};
  }

  const Eigen::Vector3i cells_;
  const int spacing_;
  const LatticeQuestion& is_too_large_;
  std::vector<int> corner_;  // site of each corner of the cells, or -1
  std::vector<Eigen::Vector3i> sites_;
  std::vector<TetCorners> tets_;                      // the ends of the longest edge come first
  std::vector<char> too_large_;                       // of each element
  std::unordered_map<std::uint64_t, int> middle_of_;  // the site on each bisected edge
};

}  // namespace

BisectedLattice bisected_lattice(const Eigen::Vector3i& cells, int halvings, const LatticeQuestion& is_needed,
                                 const LatticeQuestion& is_too_large) {
  LatticeBuilder builder(cells, halvings, is_too_large);
  const double spacing = 2 << halvings;
  for (int k = 0; k < cells.z(); ++k) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int i = 0; i < cells.x(); ++i) {
        if (is_needed(spacing * (Vec3(i, j, k) + Vec3::Constant(0.5)), 0.5 * std::sqrt(3.0) * spacing))
          builder.add_cell({i, j, k});
      }
    }
  }
  builder.bisect_all();
  builder.turn_diagonals();
  return builder.result();
}

}  // namespace supple
