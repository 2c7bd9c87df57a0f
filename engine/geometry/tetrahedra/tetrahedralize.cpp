#include "geometry/tetrahedra/tetrahedralize.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/threads.h"
#include "geometry/tetrahedra/graded_stuffing.h"
#include "geometry/tetrahedra/lattice_probe.h"
#include "geometry/tetrahedra/stuffed_lattice.h"

namespace supple {
namespace {

// Estimates the volume that the shape fills in its bounding box, from a coarse grid of samples. swell: as for
// stuffed_lattice. samples: along each side.
double sampled_volume(const Shape& shape, double swell, int samples, Threads& threads) {
  Bounds box = shape.bounds();
  box.lower.array() -= swell;
  box.upper.array() += swell;
  const LatticeProbe probe(shape, swell);
  const double step = box.extent().z() / samples;
  std::vector<int> inside(static_cast<std::size_t>(samples), 0);
  threads.run(samples, [&](int i) {
    LatticeProbe::Memory near = probe.memory();
    for (int j = 0; j < samples; ++j) {
      double known = 0, passed = 0;  // the last distance, and the way since
      for (int k = 0; k < samples; ++k, passed += step) {
        if (passed >= 0.99 * probe.clearance(known)) {
          const Vec3 unit((i + 0.5) / samples, (j + 0.5) / samples, (k + 0.5) / samples);
          known = probe.distance(box.lower + unit.cwiseProduct(box.extent()), near);
          passed = 0;
        }
        inside[static_cast<std::size_t>(i)] += known < 0 ? 1 : 0;
      }
    }
  });
  const int count = std::accumulate(inside.begin(), inside.end(), 0);
  return count * box.extent().prod() / (samples * samples * samples);
}

// Samples for a shape that may be thick everywhere, and for one that is thin somewhere.
constexpr int coarse = 24, fine = 48;

bool has_tags(const ShapeGroup& group) {
  return std::any_of(group.parts.begin(), group.parts.end(), [](const ShapePart& part) {
    const auto* inner = std::get_if<ShapeGroup>(&part.primitive);
    return part.region != 0 || (inner != nullptr && has_tags(*inner));
  });
}

// Tags the elements by the shape's parts at their centres.
void name_regions(const Shape& shape, TetMesh& mesh, Threads& threads) {
  mesh.regions.assign(static_cast<std::size_t>(mesh.tets.rows()), 0);
  if (!has_tags(shape.root)) return;
  constexpr Eigen::Index chunk = 256;
  threads.run(static_cast<int>((mesh.tets.rows() + chunk - 1) / chunk), [&](int c) {
    for (Eigen::Index e = c * chunk; e < std::min((c + 1) * chunk, mesh.tets.rows()); ++e) {
      Vec3 centroid = Vec3::Zero();
      for (int k = 0; k < 4; ++k) centroid += 0.25 * mesh.rest.row(mesh.tets(e, k)).transpose();
      mesh.regions[static_cast<std::size_t>(e)] = shape.region(centroid);
    }
  });
}

Threads all_cores() { return Threads(static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))); }

[[noreturn]] void refuse_pieces(const std::string& source, double share) {
  throw InputError(
      source,
      fmt::format(
          "is not one piece: its largest holds {:.0f} % of the volume (parts must touch by more than an element)",
          100 * share));
}

void check_bounds(const Shape& shape, const std::string& source) {
  const Bounds box = shape.bounds();
  if (box.empty()) throw InputError(source, "the shape is empty: add a part such as sphere = { radius = 0.1 }");
  if (box.extent().maxCoeff() > 1e6)
    throw InputError(source,
                     "is larger than 1e6 m, or unbounded: a half space can cut or intersect a body, but not be one; "
                     "`size` or `units` make a surface smaller");
}

void check_inside(double volume, const std::string& source) {
  if (volume <= 0)
    throw InputError(source, "the shape has no inside: its parts cut each other away, or are too thin to mesh");
}

constexpr double whole = 0.85;  // share of the sampled volume, whose own error is a few per cent

// Describes a search for the spacing that gives the wanted number of vertices.
struct Search {
  double spacing;  // that of the next attempt, and in the end that of the best mesh [m]
  double volume;   // of the body, about [m^3]
  int attempts;    // at most
  bool is_graded;
  double near;       // relative difference from the wanted number that is accepted at last
  Vec3 extent;       // of the shape's box [m]
  double swell = 0;  // [spacings]

  // Tells whether it takes the nearest number that gives a mesh in one piece, also where that is not very near.
  bool takes_nearest() const { return !is_graded && swell <= 0 && near > usual_miss; }
  // Returns how many meshes of about the right number may be in pieces before the shape is refused.
  int most_in_pieces() const { return takes_nearest() ? 8 : 3; }
  // Returns how many cells a lattice of the present spacing has around the shape.
  double cells() const { return (extent / spacing + Vec3::Constant(4 + 2 * swell)).prod(); }
};

// Returns how many cells a lattice may have, or those of all attempts together. A body that fills next to nothing of
// its box needs a lattice of more points than any body is worth: a cell takes 32 bytes, and a million of them take a
// twentieth of a second.
double most_cells(int vertices) { return std::max(4e6, 100.0 * vertices); }
double most_cells_of_all_attempts(int vertices) { return std::max(1.2e7, 400.0 * vertices); }

// Throws the InputError of a search in which no mesh comes near enough to the wanted number. found: vertices of the
// best mesh, 0 where there is none. is_capped: whether lattices became too large.
[[noreturn]] void refuse_number(int vertices, Eigen::Index found, bool is_capped, const std::string& source) {
  std::string text = fmt::format("cannot be meshed with {} vertices", vertices);
  if (is_capped) {
    text +=
        fmt::format(": it fills so little of its box that lattices of more than {:.3g} million cells would be needed",
                    1e-6 * most_cells(vertices));
  } else if (found == 0 || found > vertices) {
    text += ": its thinnest part needs more of them";
  }
  if (found > 0) text += fmt::format("; {} is the nearest number that gives a mesh", found);
  throw InputError(source, text);
}

// Makes meshes until one has about the wanted number, and leaves the spacing of the mesh that it returns in the search.
// make: a function that makes the mesh of a spacing and a shift (stuffed_lattice.h). Throws InputError where no mesh
// comes near enough.
TetMesh nearest_mesh(Search& search, int vertices, const std::string& source, const MeshingListener& listener,
                     const std::function<TetMesh(double, const Vec3&, const std::function<void(double)>&)>& make) {
  // A lattice finer than this has many more points in the volume alone than are wanted. Where most of them are kept out
  // of the mesh because the shape is too thin, they are kept out of the next one, too.
  const double finest = 0.4 * search.spacing;
  TetMesh best;
  const auto miss = [&](const TetMesh& mesh) { return std::abs(static_cast<double>(mesh.rest.rows()) / vertices - 1); };
  double last_spacing = 0, last_count = 0, best_spacing = search.spacing;
  int in_pieces = 0;  // attempts
  double cells = 0;   // of all attempts
  bool is_capped = false;
  for (int attempt = 0; attempt < search.attempts; ++attempt) {
    cells += search.cells();
    is_capped = search.cells() > most_cells(vertices) || cells > most_cells_of_all_attempts(vertices);
    if (is_capped) break;
    // After six attempts at the same alignment the lattice itself is shifted, because small bodies gain and lose whole
    // layers of vertices at once.
    const Vec3 shift = Vec3(0.31, 0.17, 0.43) * (attempt < 6 ? 0.0 : 0.37 * attempt);
    const auto told = [&](double share) {
      if (listener.progress) listener.progress(attempt + 1, share);
    };
    TetMesh mesh = make(search.spacing, shift - Vec3(shift.array().floor()), told);
    const double count = std::max<double>(static_cast<double>(mesh.rest.rows()), 1.0);
    // Further attempts do not join pieces that were apart in several attempts of about the right size.
    const double held = quality(mesh).volume / search.volume;
    in_pieces += miss(mesh) < 0.1 && held < 0.75 ? 1 : 0;
    if (in_pieces == search.most_in_pieces()) refuse_pieces(source, held);
    if (listener.judge && miss(mesh) < 0.1) listener.judge(mesh);
    const bool counts = held >= whole || !search.takes_nearest();
    if (counts && (best.rest.rows() == 0 || miss(mesh) < miss(best))) {
      best = std::move(mesh);
      best_spacing = search.spacing;
    }
    if (miss(best) < 0.01 || (attempt >= 8 && miss(best) < usual_miss)) break;
    double power = 3;  // the number is about the inverse of this power of the spacing
    if (search.is_graded && attempt > 0 && count != last_count)
      power = std::clamp(std::log(count / last_count) / std::log(last_spacing / search.spacing), 1.0, 4.0);
    last_spacing = search.spacing;
    last_count = count;
    search.spacing *= std::clamp(std::pow(count / vertices, 1 / power), 0.5, 2.0);
    if (search.spacing < finest) break;
  }
  search.spacing = best_spacing;
  if (miss(best) <= search.near) return best;
  refuse_number(vertices, best.rest.rows(), is_capped, source);
}

// Throws InputError where the volume of the mesh is far below the sampled one, because then parts are missing.
void check_whole(const TetMesh& mesh, double volume, const std::string& source) {
  const double share = quality(mesh).volume / volume;
  if (share < whole) refuse_pieces(source, share);
}

}  // namespace

TetMesh tetrahedralize(const Shape& shape, int vertices, const std::string& source, const MeshingListener& listener,
                       double swell, double most_missed) {
  check_bounds(shape, source);
  Threads threads = all_cores();
  // The first guess of the spacing counts two lattice points for each cell; a small body has about as many again on its
  // surface, which the iteration corrects. The volume of a swollen shape follows from the spacing: some rounds find
  // both.
  const Bounds box = shape.bounds();
  const double near = std::max(most_missed, swell > 0 ? swollen_miss : usual_miss);
  Search search{box.diagonal() / std::cbrt(vertices), 0, 24, false, near, box.extent(), swell};
  for (int round = 0; round < (swell > 0 ? 3 : 1); ++round) {
    search.volume = sampled_volume(shape, swell * search.spacing, swell > 0 ? fine : coarse, threads);
    check_inside(search.volume, source);
    search.spacing = std::cbrt(2 * search.volume / vertices);
  }
  TetMesh mesh =
      nearest_mesh(search, vertices, source, listener, [&](double spacing, const Vec3& shift, const auto& told) {
        return stuffed_lattice(shape, spacing, shift, swell * spacing, told, threads);
      });
  if (swell > 0) search.volume = sampled_volume(shape, swell * search.spacing, fine, threads);
  check_whole(mesh, search.volume, source);
  name_regions(shape, mesh, threads);
  return mesh;
}

TetMesh graded_tetrahedralize(const Shape& shape, int vertices, const std::string& source,
                              const std::vector<ThicknessSample>& thickness, double swollen_to,
                              const MeshingListener& listener) {
  check_bounds(shape, source);
  Threads threads = all_cores();
  Search search{0, sampled_volume(shape, 0, fine, threads), 12, true, swollen_miss, shape.bounds().extent()};
  check_inside(search.volume, source);
  search.spacing = 1.2 * std::cbrt(2 * search.volume / vertices);  // thin parts take some of the vertices
  TetMesh mesh =
      nearest_mesh(search, vertices, source, listener, [&](double spacing, const Vec3& shift, const auto& told) {
        return graded_stuffing(shape, spacing, shift, thickness, swollen_to, told, threads);
      });
  check_whole(mesh, search.volume, source);
  name_regions(shape, mesh, threads);
  return mesh;
}

}  // namespace supple
