#include "geometry/tetrahedralize.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/threads.h"
#include "geometry/lattice_probe.h"
#include "geometry/stuffed_lattice.h"

namespace supple {
namespace {

// Estimates the volume that the shape fills in its bounding box, from a coarse grid of samples. swell: as for
// stuffed_lattice; a shape that needs it is thin, and so are the cells of its grid.
double sampled_volume(const Shape& shape, double swell, Threads& threads) {
  const int samples = swell > 0 ? 48 : 24;  // along each side
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

}  // namespace

TetMesh tetrahedralize(const Shape& shape, int vertices, const std::string& source, const MeshingProgress& heard,
                       double swell) {
  const Bounds box = shape.bounds();
  if (box.empty()) throw InputError(source, "the shape is empty: add a part such as sphere = { radius = 0.1 }");
  if (box.extent().maxCoeff() > 1e6) {
    throw InputError(source, "the shape is unbounded: a half space can cut or intersect a body, but not be one");
  }
  Threads threads = all_cores();
  // The first guess of the spacing counts two lattice points for each cell; a small body has about as many again on its
  // surface, which the iteration corrects. The volume of a swollen shape follows from the spacing: some rounds find
  // both.
  double spacing = box.diagonal() / std::cbrt(vertices), volume = 0;
  for (int round = 0; round < (swell > 0 ? 3 : 1); ++round) {
    volume = sampled_volume(shape, swell * spacing, threads);
    if (volume <= 0)
      throw InputError(source, "the shape has no inside: its parts cut each other away, or are too thin to mesh");
    spacing = std::cbrt(2 * volume / vertices);
  }
  // A lattice much finer than that has more points than are wanted in the volume alone: what keeps most of them out of
  // the mesh is too thin also for the next.
  const double finest = 0.4 * spacing;
  TetMesh best;
  const auto miss = [&](const TetMesh& mesh) { return std::abs(static_cast<double>(mesh.rest.rows()) / vertices - 1); };
  int in_pieces = 0;  // attempts
  for (int attempt = 0; attempt < 24; ++attempt) {
    // After six attempts at the same alignment the lattice itself is shifted, because small bodies gain and lose whole
    // layers of vertices at once.
    const Vec3 shift = Vec3(0.31, 0.17, 0.43) * (attempt < 6 ? 0.0 : 0.37 * attempt);
    const auto told = [&](double share) {
      if (heard) heard(attempt + 1, share);
    };
    TetMesh mesh = stuffed_lattice(shape, spacing, shift - Vec3(shift.array().floor()), swell * spacing, told, threads);
    const double count = std::max<double>(static_cast<double>(mesh.rest.rows()), 1.0);
    // More attempts do not join what three of about the right size have left apart.
    const double held = quality(mesh).volume / volume;
    in_pieces += miss(mesh) < 0.1 && held < 0.75 ? 1 : 0;
    if (in_pieces == 3) refuse_pieces(source, held);
    if (best.rest.rows() == 0 || miss(mesh) < miss(best)) best = std::move(mesh);
    if (miss(best) < 0.01 || (attempt >= 8 && miss(best) < 0.03)) break;
    spacing *= std::clamp(std::cbrt(count / vertices), 0.5, 2.0);
    if (spacing < finest) break;
  }
  if (miss(best) > (swell > 0 ? 0.1 : 0.03)) {
    const auto found = best.rest.rows();
    throw InputError(source,
                     fmt::format("cannot be meshed with {} vertices{}{}", vertices,
                                 found == 0 || found > vertices ? ": its thinnest part needs more of them" : "",
                                 found == 0 ? "" : fmt::format("; {} is the nearest number that gives a mesh", found)));
  }
  // With a volume far below the sampled one (whose own error is a few per cent), whole parts are missing.
  if (swell > 0) volume = sampled_volume(shape, swell * spacing, threads);
  const double share = quality(best).volume / volume;
  if (share < 0.85) refuse_pieces(source, share);
  name_regions(shape, best, threads);
  return best;
}

}  // namespace supple
