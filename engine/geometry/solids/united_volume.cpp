// Measures the volume inside closed surfaces that overlap or lie in one another.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/solids/surface_pieces.h"
#include "geometry/triangles/numbered_surface.h"

namespace supple {
namespace {

constexpr int columns_across = 256;  // columns along either side

// Holds the place where a column enters or leaves a surface.
struct Crossing {
  int column;
  double height;
  int sign;  // 1: into the solid, going up
  bool operator<(const Crossing& other) const {
    return column != other.column ? column < other.column : height < other.height;
  }
};

class Columns {
 public:
  explicit Columns(const TriMesh& mesh) : mesh_(mesh), box_(bounds_of(mesh.points)), rows_(columns_across) {
    step_ = box_.extent() / columns_across;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
      double low = corner(mesh, t, 0).y(), high = low;
      for (int k = 1; k < 3; ++k) {
        low = std::min(low, corner(mesh, t, k).y());
        high = std::max(high, corner(mesh, t, k).y());
      }
      for (int row = first_at(low, 1); row < columns_across && place(row, 1) < high; ++row)
        rows_[std::size_t(row)].push_back(t);
    }
  }

  double volume() const {
    double length = 0;
    long counted = 0;
    for (int row = 0; row < columns_across; ++row) {
      const std::vector<Crossing> crossings = crossings_of(row);
      for (std::size_t i = 0, end = 0; i < crossings.size(); i = end) {
        int winding = 0;
        double own = 0;
        for (end = i; end < crossings.size() && crossings[end].column == crossings[i].column; ++end) {
          if (winding > 0) own += crossings[end].height - crossings[end - 1].height;
          winding += crossings[end].sign;
        }
        if (winding == 0) length += own;  // else the column grazes an edge
        counted += winding == 0 ? 0 : 1;
      }
    }
    const double all = double(columns_across) * columns_across;
    return length * step_.x() * step_.y() * all / (all - double(counted));
  }

 private:
  // Columns stand at odd shares of a step, so that they miss the edges of models made on a grid.
  static double share(int axis) { return axis == 0 ? 0.5137 : 0.4829; }
  double place(int n, int axis) const { return box_.lower[axis] + (n + share(axis)) * step_[axis]; }
  int first_at(double x, int axis) const {
    const double n = std::ceil((x - box_.lower[axis]) / step_[axis] - share(axis));
    return int(std::clamp(n, 0.0, double(columns_across)));
  }

  std::vector<Crossing> crossings_of(int row) const {
    std::vector<Crossing> result;
    const double y = place(row, 1);
    for (const Eigen::Index t : rows_[std::size_t(row)]) {
      // The triangle meets the plane of the row in a line from the edge that goes down to the one that goes up.
      double from = 0, to = 0, from_height = 0, to_height = 0;
      for (int k = 0; k < 3; ++k) {
        const Vec3 a = corner(mesh_, t, k), b = corner(mesh_, t, (k + 1) % 3);
        if ((a.y() <= y) == (b.y() <= y)) continue;
        const double s = (y - a.y()) / (b.y() - a.y());
        (a.y() <= y ? to : from) = a.x() + s * (b.x() - a.x());
        (a.y() <= y ? to_height : from_height) = a.z() + s * (b.z() - a.z());
      }
      const double low = std::min(from, to), high = std::max(from, to);
      for (int column = first_at(low, 0); column < columns_across && place(column, 0) < high; ++column) {
        const double s = (place(column, 0) - from) / (to - from);
        result.push_back({column, from_height + s * (to_height - from_height), from < to ? -1 : 1});
      }
    }
    std::sort(result.begin(), result.end());
    return result;
  }

  const TriMesh& mesh_;
  const Bounds box_;
  Vec3 step_;
  std::vector<std::vector<Eigen::Index>> rows_;  // the triangles that meet each
};

}  // namespace

double united_volume(const TriMesh& boundary) {
  const Bounds box = bounds_of(boundary.points);
  if (box.empty() || !(box.extent().x() > 0) || !(box.extent().y() > 0)) return 0;
  return Columns(boundary).volume();
}

}  // namespace supple
