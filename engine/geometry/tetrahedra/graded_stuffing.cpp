#include "geometry/tetrahedra/graded_stuffing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "geometry/tetrahedra/bisected_lattice.h"
#include "geometry/tetrahedra/cut_elements.h"
#include "geometry/tetrahedra/lattice_probe.h"

namespace supple {
namespace {

// With the wanted number of vertices fixed, a second halving would make the rest so coarse that all of it is thin.
constexpr int halvings = 1;

// An element is too large where the shape is thinner than this many of its spacings. A larger number makes more of the
// body fine and the rest coarse; a smaller one swells more of the body.
constexpr double spacings_across = 1.1;

// An element counts as being at a thin place where its middle is nearer to the place than this share of the element's
// spacing plus half of the thickness.
constexpr double refined_around = 0.8;

// The shape is swollen fully where a thin place is nearer than this share of the spacing there plus half of the
// thickness, and less and less up to twice as far.
constexpr double swollen_around = 0.7;

// A cut point that is nearer to a lattice point than this share of the point's shortest edge pulls it onto the surface.
// Of the shares from 0.25 to 0.45, this one gives the best angles on eight models (8 to 162 degrees).
constexpr double snap_share = 0.35;

// Knows where a shape is thin for the elements of a lattice.
class ThinPlaces {
 public:
  // origin: a place near the shape [m]. spacing: the largest of the lattice [m]. swollen_to: see graded_stuffing.
  ThinPlaces(const std::vector<ThicknessSample>& thickness, const Vec3& origin, double spacing, double swollen_to)
      : origin_(origin), cell_(spacing) {
    for (const ThicknessSample& sample : thickness) {
      double own = spacing;  // of the elements there
      for (int level = 0; level < halvings && sample.thickness < spacings_across * own; ++level) own /= 2;
      if (!(sample.thickness < std::max(spacings_across * spacing, swollen_to * own))) continue;
      const Place place{sample.middle(), sample.thickness, swollen_around * own + 0.5 * sample.thickness,
                        std::max(0.0, 0.5 * (swollen_to * own - sample.thickness))};
      most_swell_ = std::max(most_swell_, place.swell);
      add(place);
    }
  }

  double most_swell() const { return most_swell_; }

  // Tells whether an element of this spacing is too large there.
  bool are_too_thin(const Vec3& p, double spacing) const {
    const auto near = cells_.find(cell_of(p));
    if (near == cells_.end()) return false;
    return std::any_of(near->second.begin(), near->second.end(), [&](std::uint32_t number) {
      const Place& place = places_[number];
      return place.thickness < spacings_across * spacing &&
             (p - place.middle).squaredNorm() < std::pow(refined_around * spacing + 0.5 * place.thickness, 2);
    });
  }

  // Returns by how much the shape is swollen there: fully near a thin place, and less and less around it.
  double swell(const Vec3& p) const {
    const auto near = cells_.find(cell_of(p));
    if (near == cells_.end()) return 0;
    double most = 0;
    for (const std::uint32_t number : near->second) {
      const Place& place = places_[number];
      const double away = (p - place.middle).norm() / place.reach;
      if (away < 2) most = std::max(most, place.swell * std::min(1.0, 2 - away));
    }
    return most;
  }

 private:
  struct Place {
    Vec3 middle;
    double thickness, reach, swell;  // [m]
  };

  std::uint64_t key(const Eigen::Vector3i& cell) const {
    const auto part = [](int n) { return static_cast<std::uint64_t>(n + (1 << 20)) & 0x1fffff; };
    return part(cell.x()) << 42 | part(cell.y()) << 21 | part(cell.z());
  }
  Eigen::Vector3i cell_at(const Vec3& p) const { return ((p - origin_) / cell_).array().floor().cast<int>(); }
  std::uint64_t cell_of(const Vec3& p) const { return key(cell_at(p)); }

  // Names the place in all cubes of a grid in which it can matter.
  void add(const Place& place) {
    const auto number = static_cast<std::uint32_t>(places_.size());
    places_.push_back(place);
    const double reach = std::max(2 * place.reach, refined_around * cell_ + 0.5 * place.thickness);
    const Eigen::Vector3i low = cell_at(place.middle.array() - reach), high = cell_at(place.middle.array() + reach);
    for (int k = low.z(); k <= high.z(); ++k)
      for (int j = low.y(); j <= high.y(); ++j)
        for (int i = low.x(); i <= high.x(); ++i) cells_[key({i, j, k})].push_back(number);
  }

  const Vec3 origin_;
  const double cell_;  // edge [m]
  double most_swell_ = 0;
  std::vector<Place> places_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;  // numbers of places by cube
};

class GradedStuffing {
 public:
  GradedStuffing(const Shape& shape, double spacing, const Vec3& shift, const std::vector<ThicknessSample>& thickness,
                 double swollen_to, const std::function<void(double)>& heard, Threads& threads)
      : probe_(shape),
        thin_places_(thickness, shape.bounds().lower, spacing, swollen_to),
        unit_(spacing / (2 << halvings)),
        heard_(heard),
        threads_(threads) {
    const Bounds box = shape.bounds();
    origin_ = box.lower - (1.5 * Vec3::Ones() + shift) * spacing;
    const Vec3 cells = (box.extent() / spacing + Vec3::Constant(4)).array().ceil();
    constexpr double most_cells = 2e7;  // a body with more fills next to nothing of its box
    if (cells.prod() > most_cells) return;
    lattice_ = bisected_lattice(cells.cast<int>(), halvings, needed(), too_large());
  }

  TetMesh run() {
    sample();
    find_cuts();
    snap();
    for (const auto& tet : lattice_.tets) emit(tet);
    return oriented_mesh(vertices_, tets_);
  }

 private:
  using Corners = std::array<int, 4>;

  // Describes an edge of the lattice that the surface cuts.
  struct CutEdge {
    int from, to;         // sites, from < to
    double fraction = 0;  // where the surface cuts it, as a share of the way
    int vertex = -1;
    bool is_cut = true;  // false once one of its ends was moved onto the surface
    bool operator<(const CutEdge& other) const { return from != other.from ? from < other.from : to < other.to; }
    bool operator==(const CutEdge& other) const { return from == other.from && to == other.to; }
  };

  Vec3 lattice_position(int site) const { return origin_ + unit_ * lattice_.sites[std::size_t(site)].cast<double>(); }

  // Returns the question whether anything of a ball around a cell may be inside.
  LatticeQuestion needed() {
    return [this, near = probe_.memory()](const Vec3& middle, double radius) mutable {
      const double distance = probe_.distance(origin_ + unit_ * middle, near);
      return distance < 0 || probe_.clearance(distance) < 1.01 * unit_ * radius + thin_places_.most_swell();
    };
  }

  LatticeQuestion too_large() const {
    return [this](const Vec3& middle, double spacing) {
      return thin_places_.are_too_thin(origin_ + unit_ * middle, unit_ * spacing);
    };
  }

  template <class Visit>
  void run_chunks(std::size_t count, double done_before, const Visit& visit) {
    constexpr std::size_t size = 256;
    constexpr int at_once = 8, passes = 2;
    const int chunks = int((count + size - 1) / size);
    for (int first = 0; first < chunks; first += at_once) {
      const int some = std::min(at_once, chunks - first);
      threads_.run(some, [&](int n) {
        LatticeProbe::Memory near = probe_.memory();
        const std::size_t begin = std::size_t(first + n) * size;
        for (std::size_t i = begin; i < std::min(begin + size, count); ++i) visit(i, near);
      });
      if (heard_) heard_(done_before + (first + some) / double(passes * chunks));
    }
  }

  void sample() {
    field_.resize(lattice_.sites.size());
    run_chunks(field_.size(), 0, [&](std::size_t s, LatticeProbe::Memory& near) {
      const Vec3 p = lattice_position(int(s));
      field_[s] = probe_.distance(p, near) - thin_places_.swell(p);
    });
  }

  void find_cuts() {
    for (const Corners& tet : lattice_.tets) {
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j) {
          if ((field_[std::size_t(tet[i])] < 0) != (field_[std::size_t(tet[j])] < 0))
            cuts_.push_back({std::min(tet[i], tet[j]), std::max(tet[i], tet[j])});
        }
      }
    }
    std::sort(cuts_.begin(), cuts_.end());
    cuts_.erase(std::unique(cuts_.begin(), cuts_.end()), cuts_.end());
    run_chunks(cuts_.size(), 0.5,
               [&](std::size_t c, LatticeProbe::Memory& near) { cuts_[c].fraction = find_cut(cuts_[c], near); });
  }

  // Finds the surface on an edge by false position, where the value at an end that stays for two steps is halved
  // (Dowell and Jarratt 1971, the Illinois algorithm).
  double find_cut(const CutEdge& edge, LatticeProbe::Memory& near) const {
    const Vec3 from = lattice_position(edge.from), way = lattice_position(edge.to) - from;
    const double length = way.norm();
    LatticeProbe::Way asked(probe_, from, length, near);
    double low = 0, high = 1, at_low = field_[std::size_t(edge.from)], at_high = field_[std::size_t(edge.to)];
    double t = 0;
    int stays = 0;  // the end that the last step left where it was: -1 low, 1 high
    for (int step = 0; step < 30; ++step) {
      t = std::clamp(low + (high - low) * at_low / (at_low - at_high), low, high);
      const Vec3 p = from + t * way;
      const double value = asked.distance(p, length * std::max(t - low, high - t)) - thin_places_.swell(p);
      if (std::abs(value) < 1e-7 * length || high - low < 1e-7) break;
      if ((value < 0) == (at_low < 0)) {
        low = t;
        at_low = value;
        if (stays == 1) at_high *= 0.5;
        stays = 1;
      } else {
        high = t;
        at_high = value;
        if (stays == -1) at_low *= 0.5;
        stays = -1;
      }
    }
    return t;
  }

  void snap() {
    std::vector<std::vector<std::size_t>> cuts_at(lattice_.sites.size());
    for (std::size_t c = 0; c < cuts_.size(); ++c) {
      cuts_at[std::size_t(cuts_[c].from)].push_back(c);
      cuts_at[std::size_t(cuts_[c].to)].push_back(c);
    }
    moved_.assign(lattice_.sites.size(), Vec3::Zero());
    for (std::size_t s = 0; s < cuts_at.size(); ++s) {
      double nearest = snap_share * lattice_.shortest[s] * unit_;
      Vec3 target = Vec3::Zero();
      bool found = false;
      for (const std::size_t c : cuts_at[s]) {
        const CutEdge& edge = cuts_[c];
        if (!edge.is_cut) continue;
        const int other = edge.from == int(s) ? edge.to : edge.from;
        const double share = edge.from == int(s) ? edge.fraction : 1 - edge.fraction;
        const Vec3 way = share * (lattice_position(other) - lattice_position(int(s)));
        if (way.norm() >= nearest) continue;
        nearest = way.norm();
        target = way;
        found = true;
      }
      if (!found) continue;
      for (const std::size_t c : cuts_at[s]) cuts_[c].is_cut = false;
      moved_[s] = target;
      field_[s] = 0;
    }
  }

  int vertex(int site) {
    if (site_vertex_.empty()) site_vertex_.assign(lattice_.sites.size(), -1);
    int& name = site_vertex_[std::size_t(site)];
    if (name < 0) name = add_vertex(lattice_position(site) + moved_[std::size_t(site)]);
    return name;
  }

  int cut_vertex(int a, int b) {
    CutEdge& edge = *std::lower_bound(cuts_.begin(), cuts_.end(), CutEdge{std::min(a, b), std::max(a, b)});
    if (edge.vertex < 0) {
      const Vec3 from = lattice_position(edge.from);
      edge.vertex = add_vertex(from + edge.fraction * (lattice_position(edge.to) - from));
    }
    return edge.vertex;
  }

  int add_vertex(const Vec3& place) {
    vertices_.push_back(place.transpose());
    return static_cast<int>(vertices_.size()) - 1;
  }

  void add(int a, int b, int c, int d) { tets_.push_back({a, b, c, d}); }

  // On a face with the corners a and b inside and `out` outside, the diagonal of what is kept starts at the cut of the
  // longer edge to `out`, or, if they are equally long, of the one with the later corner. This is an order, so that the
  // diagonals on the sides of a prism never form a circle, which would leave no way to cut it. Tells whether the
  // diagonal starts at a's cut.
  bool starts_at_first(int a, int b, int out) const {
    const auto length = [&](int s) {
      return (lattice_.sites[std::size_t(s)] - lattice_.sites[std::size_t(out)]).squaredNorm();
    };
    return length(a) != length(b) ? length(a) > length(b) : a > b;
  }

  // Adds the pyramid over the quadrilateral (a, b, b_cut, a_cut).
  void add_pyramid(int apex, int a, int b, int b_cut, int a_cut, bool from_a_cut) {
    if (from_a_cut) {
      add(apex, a, b, a_cut);
      add(apex, b, b_cut, a_cut);
    } else {
      add(apex, a, b, b_cut);
      add(apex, a, b_cut, a_cut);
    }
  }

  // Adds the prism between the triangles a and b. rises[k]: the diagonal of the side from k to k + 1 joins a[k] and
  // b[k + 1], else a[k + 1] and b[k]. They must not all be alike.
  void add_prism(const std::array<int, 3>& a, const std::array<int, 3>& b, const std::array<bool, 3>& rises) {
    std::size_t k = 0;
    while (!rises[k] || rises[(k + 2) % 3]) ++k;  // two diagonals meet at a[k]
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    add(a[k], b[k], b[next], b[last]);
    add_pyramid(a[k], a[next], a[last], b[last], b[next], !rises[next]);
  }

  void emit_two_inside(int a, int b, int c, int d) {
    const int ac = cut_vertex(a, c), ad = cut_vertex(a, d), bc = cut_vertex(b, c), bd = cut_vertex(b, d);
    const bool first = !starts_at_first(a, b, c), last = starts_at_first(a, b, d);
    const auto squared_length = [&](int p, int q) {
      return (vertices_[std::size_t(p)] - vertices_[std::size_t(q)]).squaredNorm();
    };
    const bool shorter = squared_length(ac, bd) <= squared_length(bc, ad);
    add_prism({vertex(a), ac, ad}, {vertex(b), bc, bd}, {first, first == last ? !first : shorter, last});
  }

  void emit(const Corners& corners) {
    const CornersBySide sides(corners, [&](int s) { return field_[std::size_t(s)]; });
    const auto& [in, out, on, ins, outs, ons] = sides;
    if (ins == 0) return;
    if (outs == 0) {
      add(vertex(corners[0]), vertex(corners[1]), vertex(corners[2]), vertex(corners[3]));
    } else if (ins == 1) {
      std::array<int, 3> others{};
      for (std::size_t k = 0; k < ons; ++k) others[k] = vertex(on[k]);
      for (std::size_t k = 0; k < outs; ++k) others[ons + k] = cut_vertex(in[0], out[k]);
      add(vertex(in[0]), others[0], others[1], others[2]);
    } else if (ins == 3) {
      add_prism({vertex(in[0]), vertex(in[1]), vertex(in[2])},
                {cut_vertex(in[0], out[0]), cut_vertex(in[1], out[0]), cut_vertex(in[2], out[0])},
                {!starts_at_first(in[0], in[1], out[0]), !starts_at_first(in[1], in[2], out[0]),
                 !starts_at_first(in[2], in[0], out[0])});
    } else if (outs == 1) {
      add_pyramid(vertex(on[0]), vertex(in[0]), vertex(in[1]), cut_vertex(in[1], out[0]), cut_vertex(in[0], out[0]),
                  starts_at_first(in[0], in[1], out[0]));
    } else {
      emit_two_inside(in[0], in[1], out[0], out[1]);
    }
  }

  const LatticeProbe probe_;
  const ThinPlaces thin_places_;
  const double unit_;  // the lattice's unit of length [m]
  const std::function<void(double)>& heard_;
  Threads& threads_;
  Vec3 origin_;
  BisectedLattice lattice_;
  std::vector<double> field_;     // distance at each site; 0 where the site was moved onto the surface
  std::vector<Vec3> moved_;       // displacement of each site [m]
  std::vector<CutEdge> cuts_;     // sorted
  std::vector<int> site_vertex_;  // vertex at each site, or -1
  std::vector<Eigen::RowVector3d> vertices_;
  std::vector<Corners> tets_;
};

}  // namespace

TetMesh graded_stuffing(const Shape& shape, double spacing, const Vec3& shift,
                        const std::vector<ThicknessSample>& thickness, double swollen_to,
                        const std::function<void(double)>& heard, Threads& threads) {
  return one_manifold_piece(GradedStuffing(shape, spacing, shift, thickness, swollen_to, heard, threads).run());
}

}  // namespace supple
