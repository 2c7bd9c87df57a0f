#include "geometry/tetrahedralize.h"

#include <array>
#include <cmath>
#include <numeric>
#include <thread>

#include "base/error.h"
#include "base/threads.h"
#include "geometry/shape_probe.h"
#include "geometry/stuffed_lattice.h"

namespace supple {
namespace {

// Estimates the volume that the shape fills in its bounding box, from a coarse grid of samples.
double sampled_volume(const Shape& shape, const Bounds& box, Threads& threads) {
  constexpr int samples = 24;
  const ShapeProbe probe(shape);
  std::array<int, samples> inside{};
  threads.run(samples, [&](int i) {
    for (int j = 0; j < samples; ++j) {
      for (int k = 0; k < samples; ++k) {
        const Vec3 unit((i + 0.5) / samples, (j + 0.5) / samples, (k + 0.5) / samples);
        inside[static_cast<std::size_t>(i)] += probe.distance(box.lower + unit.cwiseProduct(box.extent())) < 0 ? 1 : 0;
      }
    }
  });
  const int count = std::accumulate(inside.begin(), inside.end(), 0);
  return count * box.extent().prod() / (samples * samples * samples);
}

Threads all_cores() { return Threads(static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))); }

}  // namespace

TetMesh tetrahedralize(const Shape& shape, int vertices, const std::string& source, const MeshingProgress& heard) {
  const Bounds box = shape.bounds();
  if (box.empty()) throw InputError(source, "the shape is empty: add a part such as sphere = { radius = 0.1 }");
  if (box.extent().maxCoeff() > 1e6) {
    throw InputError(source, "the shape is unbounded: a half space can cut or intersect a body, but not be one");
  }
  Threads threads = all_cores();
  const double volume = sampled_volume(shape, box, threads);
  if (volume <= 0)
    throw InputError(source, "the shape has no inside: its parts cut each other away, or are too thin to mesh");

  // The first guess of the spacing counts two lattice points for each cell; a small body has about as many again on its
  // surface, which the iteration corrects.
  double spacing = std::cbrt(2 * volume / vertices);
  TetMesh best;
  const auto miss = [&](const TetMesh& mesh) { return std::abs(static_cast<double>(mesh.rest.rows()) / vertices - 1); };
  for (int attempt = 0; attempt < 24; ++attempt) {
    // After six attempts at the same alignment the lattice itself is shifted, because small bodies gain and lose whole
    // layers of vertices at once.
    const Vec3 shift = Vec3(0.31, 0.17, 0.43) * (attempt < 6 ? 0.0 : 0.37 * attempt);
    const auto told = [&](double share) {
      if (heard) heard(attempt + 1, share);
    };
    TetMesh mesh = stuffed_lattice(shape, spacing, shift - Vec3(shift.array().floor()), told, threads);
    const double count = std::max<double>(static_cast<double>(mesh.rest.rows()), 1.0);
    if (best.rest.rows() == 0 || miss(mesh) < miss(best)) best = std::move(mesh);
    if (miss(best) < 0.01 || (attempt >= 8 && miss(best) < 0.03)) break;
    spacing *= std::clamp(std::cbrt(count / vertices), 0.5, 2.0);
  }
  if (miss(best) > 0.03) {
    throw InputError(
        source,
        fmt::format("cannot be meshed with {} vertices{}; {} is the nearest number that gives a mesh", vertices,
                    best.rest.rows() > vertices ? ": its thinnest part needs more of them" : "", best.rest.rows()));
  }
  // With a volume far below the sampled one (whose own error is a few per cent), whole parts are missing.
  const double share = quality(best).volume / volume;
  if (share < 0.85) {
    throw InputError(
        source,
        fmt::format(
            "is not one piece: its largest holds {:.0f} % of the volume (parts must touch by more than an element)",
            100 * share));
  }
  return best;
}

}  // namespace supple
