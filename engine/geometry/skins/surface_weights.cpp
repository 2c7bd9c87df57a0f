#include "geometry/skins/surface_weights.h"

#include <algorithm>
#include <cmath>

namespace supple {

Vec3 weighted_point(const SurfaceWeights& weights, Eigen::Index row, const Positions& mesh) {
  double x = 0, y = 0, z = 0;
  const double* places = mesh.data();
  const std::int32_t begin = weights.begin[std::size_t(row)], end = weights.begin[std::size_t(row) + 1];
  const std::int32_t* vertex = weights.vertex.data();
  const double* weight = weights.weight.data();
  for (std::int32_t i = begin; i < end; ++i) {
    const double* place = places + 3 * std::size_t(vertex[i]);
    x += weight[i] * place[0];
    y += weight[i] * place[1];
    z += weight[i] * place[2];
  }
  return {x, y, z};
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
