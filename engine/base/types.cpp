#include "base/types.h"

namespace supple {

bool Bounds::empty() const { return (lower.array() > upper.array()).any(); }
Vec3 Bounds::extent() const { return empty() ? Vec3(Vec3::Zero()) : Vec3(upper - lower); }
Vec3 Bounds::center() const { return 0.5 * (lower + upper); }
double Bounds::diagonal() const { return extent().norm(); }

Bounds bounds_of(const Positions& points) {
  Bounds box;
  for (Eigen::Index i = 0; i < points.rows(); ++i) box.include(points.row(i).transpose());
  return box;
}

}  // namespace supple
