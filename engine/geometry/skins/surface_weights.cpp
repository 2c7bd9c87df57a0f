#include "geometry/skins/surface_weights.h"

#include <algorithm>
#include <cmath>

namespace supple {

Vec3 weighted_point(const SurfaceWeights& weights, Eigen::Index row, const Positions& mesh) {
  Vec3 sum = Vec3::Zero();
  const std::int32_t end = weights.begin[std::size_t(row) + 1];
  for (std::int32_t i = weights.begin[std::size_t(row)]; i < end; ++i)
    sum += weights.weight[std::size_t(i)] * mesh.row(weights.vertex[std::size_t(i)]).transpose();
  return sum;
}

double weighted_value(const SurfaceWeights& weights, Eigen::Index row, const std::vector<double>& by_vertex) {
  double sum = 0, low = infinity, high = -infinity;
  for (std::int32_t i = weights.begin[std::size_t(row)]; i < weights.begin[std::size_t(row) + 1]; ++i) {
    const double value = by_vertex[std::size_t(weights.vertex[std::size_t(i)])];
    sum += weights.weight[std::size_t(i)] * value;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return std::isnan(sum) ? sum : std::clamp(sum, low, high);
}

}  // namespace supple
