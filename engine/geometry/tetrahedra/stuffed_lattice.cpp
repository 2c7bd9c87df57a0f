#include "geometry/tetrahedra/stuffed_lattice.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "base/error.h"
#include "geometry/tetrahedra/cut_elements.h"
#include "geometry/tetrahedra/lattice_probe.h"

namespace supple {
namespace {

// A cut point within these fractions of an edge pulls its lattice point onto the surface. They are the pair for which
// the paper's computer search proves the dihedral angles (Labelle and Shewchuk 2007, section 4, uniform tetrahedra).
constexpr double snap_long = 0.24999;
constexpr double snap_short = 0.41189;

// Lattice coordinates count half spacings: even triples are cell corners, odd triples are cell centres.
using Site = std::array<int, 3>;

constexpr Site forward_edges[7] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};
constexpr int long_edges = 3;  // the first three are the long ones

Bounds grown(Bounds box, double by) {
  box.lower.array() -= by;
  box.upper.array() += by;
  return box;
}

class IsosurfaceStuffing {
 public:
  IsosurfaceStuffing(const Shape& shape, double spacing, const Vec3& shift, double swell,
                     const std::function<void(double)>& heard, Threads& threads)
      : probe_(shape, swell), spacing_(spacing), heard_(heard), threads_(threads) {
    const Bounds box = grown(shape.bounds(), swell);
    origin_ = box.lower - (1.5 * Vec3::Ones() + shift) * spacing;
    for (int axis = 0; axis < 3; ++axis) {
      cells_[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil(box.extent()[axis] / spacing + 4));
    }
    const auto layers = static_cast<std::size_t>(2 * cells_[2] + 1);
    const std::size_t sites =
        layers * static_cast<std::size_t>(cells_[1] + 1) * static_cast<std::size_t>(cells_[0] + 1);
    field_.assign(sites, 1.0);
    cuts_of_.assign(sites, -1);
    site_vertex_.assign(sites, -1);
  }

  TetMesh run() {
    sample();
    find_cuts();
    snap();
    emit_all();
    return oriented_mesh(vertices_, tets_);
  }

 private:
  static constexpr double no_cut = -1;

  // Describes a site with cut edges.
  struct Cuts {
    Site site;
    Vec3 moved = Vec3::Zero();      // displacement of the site [m]
    std::array<double, 7> cut;      // fraction at which each forward edge is cut, or no_cut
    std::array<int, 7> cut_vertex;  // vertex on each forward edge, or -1
    explicit Cuts(const Site& at) : site(at) {
      cut.fill(no_cut);
      cut_vertex.fill(-1);
    }
  };

  bool inside_lattice(const Site& s) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (s[axis] < 0 || s[axis] > 2 * cells_[axis]) return false;
    }
    return true;
  }
  std::size_t id(const Site& s) const {
    return (static_cast<std::size_t>(s[2]) * static_cast<std::size_t>(cells_[1] + 1) +
            static_cast<std::size_t>(s[1] / 2)) *
               static_cast<std::size_t>(cells_[0] + 1) +
           static_cast<std::size_t>(s[0] / 2);
  }
  Vec3 lattice_position(const Site& s) const { return origin_ + 0.5 * spacing_ * Vec3(s[0], s[1], s[2]); }
  Vec3 position(const Site& s) const {
    const int cuts = cuts_of_[id(s)];
    return cuts < 0 ? lattice_position(s) : Vec3(lattice_position(s) + cuts_[std::size_t(cuts)].moved);
  }

  // Runs some chunks at a time, and tells what share of the work is done. Sampling and finding cuts take nearly all of
  // the time, and so count as half of the work each.
  template <class Visit>
  void run_chunks(int chunks, double done_before, const Visit& visit) {
    constexpr int at_once = 8, passes = 2;
    for (int first = 0; first < chunks; first += at_once) {
      const int count = std::min(at_once, chunks - first);
      threads_.run(count, [&](int n) { visit(first + n); });
      if (heard_) heard_(done_before + (first + count) / double(passes * chunks));
    }
  }

  int layers() const { return 2 * cells_[2] + 1; }

  template <class Visit>
  void for_each_site_of(int k, const Visit& visit) {
    for (int j = k % 2; j <= 2 * cells_[1] - k % 2; j += 2)
      for (int i = k % 2; i <= 2 * cells_[0] - k % 2; i += 2) visit(Site{i, j, k});
  }

  void sample() {
    constexpr int thickness = 8;  // layers of a chunk
    run_chunks((layers() + thickness - 1) / thickness, 0, [&](int chunk) {
      LatticeProbe::Memory near = probe_.memory();
      const int first = chunk * thickness;
      for (int k = first; k < std::min(first + thickness, layers()); ++k)
        for_each_site_of(k, [&](const Site& s) { sample_at(s, first, near); });
    });
  }

  // Sets the field at a site. Where the sites before it show that the surface is so far away that all of the site's
  // edges lie on one side, nothing is asked, and the field is only a bound: its sign is right, and the surface is at
  // least as far away as clearance() says for it.
  void sample_at(const Site& s, int first_layer, LatticeProbe::Memory& near) {
    double clear = -1, side = 1;
    const auto look = [&](const Site& before, double away) {
      const double known = field_[id(before)], left = probe_.clearance(known) - away * spacing_;
      if (left <= clear) return;
      clear = left;
      side = known;
    };
    if (s[0] >= 2) look({s[0] - 2, s[1], s[2]}, 1);
    if (s[1] >= 2) look({s[0], s[1] - 2, s[2]}, 1);
    if (s[2] > first_layer) {
      for (const int dj : {-1, 1}) {
        for (const int di : {-1, 1}) {
          const Site below{s[0] + di, s[1] + dj, s[2] - 1};
          if (inside_lattice(below)) look(below, 0.8661);  // half of the diagonal of a cell
        }
      }
    }
    field_[id(s)] = clear > longest_edge * spacing_ ? std::copysign(clear / probe_.clearance(1), side)
                                                    : probe_.distance(lattice_position(s), near);
  }

  // Finds the cut's parameter along a -> b by bisection, starting from the secant's guess; the field has opposite signs
  // at a and b.
  double find_cut(const Site& a, const Site& b, LatticeProbe::Memory& near) const {
    const Vec3 from = lattice_position(a), to = lattice_position(b);
    const double length = (to - from).norm();
    LatticeProbe::Way way(probe_, from, length, near);
    double low = 0, high = 1;
    const bool low_inside = field_[id(a)] < 0;
    double t = field_[id(a)] / (field_[id(a)] - field_[id(b)]);
    for (int step = 0; step < 30; ++step) {
      const double value = way.distance(from + t * (to - from), length * std::max(t - low, high - t));
      if (std::abs(value) < 1e-9 * spacing_) break;
      ((value < 0) == low_inside ? low : high) = t;
      if (high - low < 1e-7) break;
      t = 0.5 * (low + high);
    }
    return t;
  }

  // Lists the sites with cut edges, in the order of layers, rows and places in a row, and finds where their forward
  // edges are cut.
  void find_cuts() {
    std::vector<std::vector<Site>> by_layer{std::size_t(layers())};
    threads_.run(layers(), [&](int k) {
      for_each_site_of(k, [&](const Site& s) {
        if (has_cuts(s)) by_layer[std::size_t(k)].push_back(s);
      });
    });
    for (const std::vector<Site>& layer : by_layer) {
      for (const Site& s : layer) {
        cuts_of_[id(s)] = int(cuts_.size());
        cuts_.emplace_back(s);
      }
    }
    constexpr int size = 64;  // sites of a chunk
    const int count = int(cuts_.size());
    run_chunks((count + size - 1) / size, 0.5, [&](int chunk) {
      LatticeProbe::Memory near = probe_.memory();
      for (int c = chunk * size; c < std::min((chunk + 1) * size, count); ++c) {
        Cuts& cuts = cuts_[std::size_t(c)];
        for (std::size_t e = 0; e < 7; ++e) {
          const Site other = stepped(cuts.site, forward_edges[e], 1);
          if (is_cut(cuts.site, other)) cuts.cut[e] = find_cut(cuts.site, other, near);
        }
      }
    });
  }

  bool has_cuts(const Site& s) const {
    for (const Site& edge : forward_edges)
      if (is_cut(s, stepped(s, edge, 1)) || is_cut(s, stepped(s, edge, -1))) return true;
    return false;
  }

  bool is_cut(const Site& s, const Site& other) const {
    return inside_lattice(other) && (field_[id(s)] < 0) != (field_[id(other)] < 0);
  }

  static Site stepped(const Site& s, const Site& edge, int sign) {
    return {s[0] + sign * edge[0], s[1] + sign * edge[1], s[2] + sign * edge[2]};
  }

  // Calls visit(the cut's fraction as it is kept, the other end, the fraction from the site, the edge's direction) for
  // each cut edge of a site. The kept fraction is that from the end for which the edge is a forward one.
  template <class Visit>
  void for_each_cut(Cuts& cuts, const Visit& visit) {
    for (std::size_t e = 0; e < 7; ++e) {
      const Site ahead = stepped(cuts.site, forward_edges[e], 1), behind = stepped(cuts.site, forward_edges[e], -1);
      if (cuts.cut[e] != no_cut) visit(cuts.cut[e], ahead, cuts.cut[e], int(e));
      if (!inside_lattice(behind) || cuts_of_[id(behind)] < 0) continue;
      double& back = cuts_[std::size_t(cuts_of_[id(behind)])].cut[e];
      if (back != no_cut) visit(back, behind, 1 - back, int(e));
    }
  }

  void snap() {
    for (Cuts& cuts : cuts_) {
      double nearest = 1;  // in units of the edge's own snapping distance
      Vec3 target = Vec3::Zero();
      for_each_cut(cuts, [&](double, const Site& other, double fraction, int edge) {
        const double relative = fraction / (edge < long_edges ? snap_long : snap_short);
        if (relative >= nearest) return;
        nearest = relative;
        target = fraction * (lattice_position(other) - lattice_position(cuts.site));
      });
      if (nearest >= 1) continue;
      for_each_cut(cuts, [&](double& cut, const Site&, double, int) { cut = no_cut; });
      cuts.moved = target;
      field_[id(cuts.site)] = 0;
    }
  }

  static bool is_long(const Site& a, const Site& b) { return (a[0] + b[0]) % 2 == 0; }

  int vertex(const Site& s) {
    int& number = site_vertex_[id(s)];
    if (number < 0) {
      number = static_cast<int>(vertices_.size());
      vertices_.push_back(position(s).transpose());
    }
    return number;
  }

  int cut_vertex(const Site& a, const Site& b) {
    for (int e = 0; e < 7; ++e) {
      for (const bool swapped : {false, true}) {
        const Site& from = swapped ? b : a;
        if (stepped(from, forward_edges[e], 1) != (swapped ? a : b)) continue;
        Cuts& cuts = cuts_[std::size_t(cuts_of_[id(from)])];
        const double fraction = cuts.cut[std::size_t(e)];
        SUPPLE_CHECK(fraction, >=, 0.0);
        int& number = cuts.cut_vertex[std::size_t(e)];
        if (number < 0) {
          number = static_cast<int>(vertices_.size());
          const Vec3 p = lattice_position(from), q = lattice_position(swapped ? a : b);
          vertices_.push_back((p + fraction * (q - p)).transpose());
        }
        return number;
      }
    }
    SUPPLE_CHECK(0, ==, 1);
    return -1;
  }

  // On a face with a and b inside and c outside, the kept quadrilateral is (a, b, bc, ac). Returns true when its
  // diagonal is a-bc, false when it is b-ac. Both elements at a face decide alike. With both cuts on short edges, the
  // lattice's parity decides; otherwise the diagonal starts at the cut on the long edge.
  static bool diagonal_from_first(const Site& a, const Site& b, const Site& c) {
    if (is_long(a, b)) {
      std::size_t axis = 0;
      while (a[axis] == b[axis]) ++axis;
      return (a[axis] / 2) % 2 == 0;
    }
    return is_long(b, c);
  }

  void add(int a, int b, int c, int d) { tets_.push_back({a, b, c, d}); }

  // Adds the pyramid over the quadrilateral (a, b, b_cut, a_cut).
  void add_pyramid(int apex, int a, int b, int b_cut, int a_cut, bool from_a) {
    if (from_a) {
      add(apex, a, b, b_cut);
      add(apex, a, b_cut, a_cut);
    } else {
      add(apex, a, b, a_cut);
      add(apex, b, b_cut, a_cut);
    }
  }

  void emit_three_inside(std::array<Site, 3> in, const Site& out) {
    // in[0] becomes the corner that the long edge joins to `out`. Both diagonals on its side start at the cut on that
    // edge.
    for (std::size_t k = 1; k < 3; ++k) {
      if (is_long(in[k], out)) std::swap(in[0], in[k]);
    }
    const int a = vertex(in[0]), b = vertex(in[1]), c = vertex(in[2]);
    const int a_cut = cut_vertex(in[0], out), b_cut = cut_vertex(in[1], out), c_cut = cut_vertex(in[2], out);
    add(a, b, c, a_cut);
    add_pyramid(a_cut, b, c, c_cut, b_cut, diagonal_from_first(in[1], in[2], out));
  }

  void emit_two_inside(const Site& a, const Site& b, Site c, Site d) {
    const int va = vertex(a), vb = vertex(b);
    if (!is_long(a, b) && !is_long(a, c)) std::swap(c, d);
    const int ac = cut_vertex(a, c), ad = cut_vertex(a, d), bc = cut_vertex(b, c), bd = cut_vertex(b, d);
    if (!is_long(a, b)) {
      // Here a-c and b-d are long: the diagonals are b-ac and a-bd, which leave ac-bd as the only one for the surface.
      add(va, ac, ad, bd);
      add(va, vb, ac, bd);
      add(vb, ac, bc, bd);
      return;
    }
    const double first =
        (vertices_[static_cast<std::size_t>(ac)] - vertices_[static_cast<std::size_t>(bd)]).squaredNorm();
    const double second =
        (vertices_[static_cast<std::size_t>(bc)] - vertices_[static_cast<std::size_t>(ad)]).squaredNorm();
    if (diagonal_from_first(a, b, c)) {
      add(va, vb, bc, bd);
      add_pyramid(va, ac, bc, bd, ad, first <= second);
    } else {
      add(vb, va, ac, ad);
      add_pyramid(vb, ac, bc, bd, ad, first <= second);
    }
  }

  void emit(const std::array<Site, 4>& corners) {
    const CornersBySide sides(corners, [&](const Site& s) { return field_[id(s)]; });
    const auto& [in, out, on, ins, outs, ons] = sides;
    if (ins == 0) return;
    if (outs == 0) {
      add(vertex(corners[0]), vertex(corners[1]), vertex(corners[2]), vertex(corners[3]));
    } else if (ins == 1) {
      int others[3];
      for (std::size_t k = 0; k < ons; ++k) others[k] = vertex(on[k]);
      for (std::size_t k = 0; k < outs; ++k) others[ons + k] = cut_vertex(in[0], out[k]);
      add(vertex(in[0]), others[0], others[1], others[2]);
    } else if (ins == 3) {
      emit_three_inside({in[0], in[1], in[2]}, out[0]);
    } else if (outs == 1) {
      add_pyramid(vertex(on[0]), vertex(in[0]), vertex(in[1]), cut_vertex(in[1], out[0]), cut_vertex(in[0], out[0]),
                  diagonal_from_first(in[0], in[1], out[0]));
    } else {
      emit_two_inside(in[0], in[1], out[0], out[1]);
    }
  }

  // Cuts all elements of the lattice. Each has two neighbouring centres and one edge of the square between their cells.
  void emit_all() {
    for (int k = 1; k < 2 * cells_[2]; k += 2) {
      for (int j = 1; j < 2 * cells_[1]; j += 2) {
        for (int i = 1; i < 2 * cells_[0]; i += 2) {
          const double center = field_[id({i, j, k})];
          if (center > 0 && probe_.clearance(center) > longest_edge * spacing_) continue;  // all around is outside
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const Site a{i, j, k};
            Site b = a;
            b[axis] += 2;
            if (b[axis] > 2 * cells_[axis]) continue;
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            constexpr int square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
            for (int side = 0; side < 4; ++side) {
              Site c = a, d = a;
              c[axis] += 1;
              d[axis] += 1;
              c[u] += square[side][0];
              c[v] += square[side][1];
              d[u] += square[(side + 1) % 4][0];
              d[v] += square[(side + 1) % 4][1];
              emit({a, b, c, d});
            }
          }
        }
      }
    }
  }

  static constexpr double longest_edge = 1.01;  // in spacings, with room for round-off

  const LatticeProbe probe_;
  const double spacing_;
  const std::function<void(double)>& heard_;
  Threads& threads_;
  Vec3 origin_;
  std::array<int, 3> cells_{};
  std::vector<double> field_;     // distance at each site; 0 where the site was moved onto the surface
  std::vector<Cuts> cuts_;        // of the sites with cut edges
  std::vector<int> cuts_of_;      // by site: its place among these, or -1
  std::vector<int> site_vertex_;  // vertex at each site, or -1
  std::vector<Eigen::RowVector3d> vertices_;
  std::vector<std::array<int, 4>> tets_;
};

}  // namespace

TetMesh stuffed_lattice(const Shape& shape, double spacing, const Vec3& shift, double swell,
                        const std::function<void(double)>& heard, Threads& threads) {
  return one_manifold_piece(IsosurfaceStuffing(shape, spacing, shift, swell, heard, threads).run());
}

}  // namespace supple
