#include "sim/measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace supple {
namespace {

// The largest eigenvalue of a symmetric 3 x 3 matrix, in closed form (Smith 1961, "Eigenvalues of a symmetric 3 x 3
// matrix").
double largest_eigenvalue(const Mat3& c) {
  const double mean = c.trace() / 3;
  const Mat3 d = c - mean * Mat3::Identity();
  const double p = std::sqrt(d.squaredNorm() / 6);
  if (p < 1e-150) return mean;
  const double r = std::clamp((d / p).determinant() / 2, -1.0, 1.0);
  return mean + 2 * p * std::cos(std::acos(r) / 3);
}

}  // namespace

double stretch(const Model& model, const Positions& x) {
  std::vector<std::pair<double, double>> elements;  // stretch, volume
  elements.reserve(model.elements);
  double total = 0;
  for (const Model::ChunkRange& range : model.chunks) {
    const std::int32_t* list = model.chunk_vertex.data() + range.first_vertex;
    for (int lane = range.first_block * block_width; lane < (range.first_block + range.blocks) * block_width; ++lane) {
      if (model.element_of_lane[lane] < 0) continue;
      const std::size_t block = lane / block_width, place = lane % block_width;
      const auto corner = [&](int k) -> Vec3 {
        return x.row(list[model.corner[(block * 4 + k) * block_width + place]]);
      };
      Mat3 edges, inverse;
      for (int k = 0; k < 3; ++k) edges.col(k) = corner(k + 1) - corner(0);
      for (int i = 0; i < 9; ++i) inverse(i / 3, i % 3) = model.rest_inverse[(block * 9 + i) * block_width + place];
      const Mat3 f = edges * inverse;
      elements.emplace_back(std::sqrt(std::max(0.0, largest_eigenvalue(f.transpose() * f))), model.volume[lane]);
      total += model.volume[lane];
    }
  }
  std::sort(elements.begin(), elements.end());
  double below = 0;
  for (const auto& [value, volume] : elements) {
    below += volume;
    if (below >= 0.999 * total) return value;
  }
  return 1;
}

double jiggle(const Model& model, const Positions& x, const Eigen::Isometry3d& motion) {
  double furthest2 = 0;
  for (int v = 0; v < model.vertices; ++v) {
    furthest2 = std::max(furthest2, (motion * Vec3(model.rest.row(v)) - Vec3(x.row(v))).squaredNorm());
  }
  return std::sqrt(furthest2) / model.size;
}

}  // namespace supple
