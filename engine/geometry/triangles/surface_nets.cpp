#include "geometry/triangles/surface_nets.h"

#include <algorithm>

namespace supple {

std::optional<Vec3> net_vertex(const std::array<float, 8>& value, double cell) {
  const auto inside = std::count_if(value.begin(), value.end(), [](float v) { return v < 0; });
  if (inside == 0 || inside == 8) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  int crossings = 0;
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t bit = 1; bit < 8; bit <<= 1) {
      const std::size_t b = a | bit;
      if (b == a || (value[a] < 0) == (value[b] < 0)) continue;
      const double t = value[a] / (value[a] - value[b]);
      const auto corner = [](std::size_t c) { return Vec3(double(c & 1), double(c >> 1 & 1), double(c >> 2)); };
      sum += (1 - t) * corner(a) + t * corner(b);
      ++crossings;
    }
  }
  return cell * sum / crossings;
}

TriMesh triangles_of(const QuadSurface& surface, Diagonal diagonal) {
  const auto length = [&](std::int32_t a, std::int32_t b) {
    return (surface.points[std::size_t(a)] - surface.points[std::size_t(b)]).squaredNorm();
  };
  TriMesh mesh{Positions(std::ssize(surface.points), 3), Triangles(2 * std::ssize(surface.quads), 3)};
  for (std::size_t v = 0; v < surface.points.size(); ++v)
    mesh.points.row(Eigen::Index(v)) = surface.points[v].transpose();
  Eigen::Index row = 0;
  for (const auto& [a, b, c, d] : surface.quads) {
    const bool takes_first = diagonal == Diagonal::first || length(a, c) <= length(b, d);
    mesh.triangles.row(row++) << a, b, takes_first ? c : d;
    mesh.triangles.row(row++) << (takes_first ? a : b), c, d;
  }
  return mesh;
}

}  // namespace supple
