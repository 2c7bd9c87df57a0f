#include "geometry/skins/file_corners.h"

#include <algorithm>

#include "geometry/triangles/numbered_surface.h"
#include "geometry/triangles/triangle_edges.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

// Returns the weights of a place in a triangle of the raw surface: those of the corner at which the triangle names
// `vertex` or, where it does not (-1: another triangle's vertex on its side), those of the triangle's point that is
// closest to the place.
Vec3 weights_of(const TriMesh& raw, Eigen::Index triangle, std::int32_t vertex, const Vec3& place) {
  for (int k = 0; k < 3; ++k)
    if (raw.triangles(triangle, k) == vertex) return Vec3::Unit(k);
  const Vec3 a = corner(raw, triangle, 0), b = corner(raw, triangle, 1), c = corner(raw, triangle, 2);
  return weights_in_triangle(closest_in_triangle(place, a, b, c), a, b, c);
}

std::int32_t part_at(const RemeshedPlace& place, const ColoredSurface& file) {
  return file.parts.of.empty() ? -1 : file.parts.of[std::size_t(file.mesh.triangles(place.triangle, 0))];
}

bool differ(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.allFinite() != b.allFinite() || (a - b).cwiseAbs().maxCoeff() > 1e-6;
}

}  // namespace

FileCorners corners_in(const TriMesh& raw, const WeldedSurface& welded) {
  FileCorners corners(welded.triangle_source.size());
  for (std::size_t t = 0; t < corners.size(); ++t) {
    const std::int32_t source = welded.triangle_source[t];
    for (int k = 0; k < 3; ++k)
      corners[t][std::size_t(k)] = {source, weights_of(raw, source, welded.corner_source[t][std::size_t(k)],
                                                       corner(welded.mesh, Eigen::Index(t), k))};
  }
  return corners;
}

FileCorners corners_in(const FileCorners& before, const RemeshedSurface& remeshed) {
  FileCorners corners = remeshed.corners;
  for (auto& triangle : corners) {
    for (RemeshedPlace& place : triangle) {
      const auto& from = before[std::size_t(place.triangle)];
      const Vec3 weights =
          place.weights[0] * from[0].weights + place.weights[1] * from[1].weights + place.weights[2] * from[2].weights;
      place = {from[0].triangle, weights};
    }
  }
  return corners;
}

std::vector<std::array<std::int32_t, 2>> file_seams(const TriMesh& surface, const FileCorners& corners,
                                                    const ColoredSurface& file) {
  const std::vector<TriangleEdge> edges = sorted_edges(surface.triangles);
  std::vector<std::array<std::int32_t, 2>> seams;
  const auto place = [&](const TriangleEdge& edge, bool low) -> const RemeshedPlace& {
    const int k = low == edge.upward ? edge.side : (edge.side + 1) % 3;
    return corners[std::size_t(edge.triangle)][std::size_t(k)];
  };
  for (std::size_t e = 1; e < edges.size(); ++e) {
    const TriangleEdge &one = edges[e - 1], &other = edges[e];
    if (one.low != other.low || one.high != other.high) continue;
    bool jumps = part_at(place(one, true), file) != part_at(place(other, true), file);
    for (const bool low : {true, false})
      jumps = jumps || (!file.places.empty() &&
                        differ(texture_place(place(one, low), file), texture_place(place(other, low), file)));
    if (jumps && (seams.empty() || seams.back() != std::array{one.low, one.high})) seams.push_back({one.low, one.high});
  }
  return seams;
}

Eigen::Vector2d texture_place(const RemeshedPlace& place, const ColoredSurface& file) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int k = 0; k < 3; ++k) {
    const TexturePlace& at = file.places[std::size_t(file.mesh.triangles(place.triangle, k))];
    sum += place.weights[k] * Eigen::Vector2d(at[0], at[1]);
  }
  return sum;
}

std::shared_ptr<const TextureCorners> places_on(const FileCorners& corners, const ColoredSurface& file) {
  if (file.places.empty()) return nullptr;
  auto places = std::make_shared<TextureCorners>();
  for (const auto& triangle : corners)
    places->push_back(
        {texture_place(triangle[0], file), texture_place(triangle[1], file), texture_place(triangle[2], file)});
  return places;
}

std::shared_ptr<const SurfaceParts> parts_on(const FileCorners& corners, const ColoredSurface& file) {
  if (file.parts.of.empty()) return nullptr;
  auto parts = std::make_shared<SurfaceParts>();
  parts->names = file.parts.names;
  for (const auto& triangle : corners) parts->of.push_back(part_at(triangle[0], file));
  return parts;
}

}  // namespace supple
