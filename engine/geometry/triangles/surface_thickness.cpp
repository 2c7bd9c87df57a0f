#include "geometry/triangles/surface_thickness.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/triangles/numbered_surface.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {

double area_of(const TriMesh& mesh) {
  double area = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) area += area_vector(mesh, t).norm();
  return area;
}

std::vector<ThicknessSample> sampled_thickness(const TriMesh& boundary, int count) {
  const TriangleSoup soup(boundary);
  const double step = area_of(boundary) / count, size = bounds_of(boundary.points).diagonal();
  std::vector<ThicknessSample> samples;
  double passed = 0, wanted = 0.5 * step;
  for (Eigen::Index t = 0; t < boundary.triangles.rows(); ++t) {
    passed += area_vector(boundary, t).norm();
    for (int n = 0; wanted < passed; wanted += step, ++n) {
      // Several samples of one large triangle lie apart, along a line from one of its corners to the middle between the
      // two others.
      const double share = std::fmod(1.0 / 3 + 0.6180339887498949 * n, 1.0);
      const Vec3 middle = 0.5 * (corner(boundary, t, 1) + corner(boundary, t, 2));
      const Vec3 place = corner(boundary, t, 0) + std::sqrt(share) * (middle - corner(boundary, t, 0));
      const Vec3 inward = -soup.normals().row(t).transpose();
      auto hit = soup.first_hit(place + 1e-7 * size * inward, inward, t);
      if (!hit) hit = soup.first_hit(place, inward, t);  // the solid may be thinner than that
      if (hit) samples.push_back({*hit, place, inward});
    }
  }
  std::stable_sort(samples.begin(), samples.end(),
                   [](const ThicknessSample& a, const ThicknessSample& b) { return a.thickness < b.thickness; });
  return samples;
}

double vertices_for(double volume, double area, double spacing) {
  return 2 * volume / (spacing * spacing * spacing) + area / (spacing * spacing);
}

double spacing_for(double volume, double area, double vertices) {
  double low = 0, high = std::cbrt(volume) + std::sqrt(area);
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (vertices_for(volume, area, middle) > vertices ? low : high) = middle;
  }
  return high;
}

double vertices_wanted(const std::vector<ThicknessSample>& samples, double volume, double area) {
  if (samples.empty()) return 0;
  return vertices_for(volume, area, std::max(samples[samples.size() / 20].thickness, 1e-300));
}

}  // namespace supple
