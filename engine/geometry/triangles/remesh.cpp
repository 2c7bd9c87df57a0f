#include "geometry/triangles/remesh.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geometry/triangles/numbered_surface.h"
#include "geometry/triangles/remesh_places.h"
#include "geometry/triangles/remesh_rounds.h"
#include "geometry/triangles/triangle_edges.h"
#include "geometry/triangles/welded_surface.h"

namespace supple {
namespace {

void check_options(const RemeshOptions& options, const std::string& name) {
  if (!(options.edge_length > 0 && options.edge_length < infinity))
    throw InputError(name, fmt::format("cannot have edges of {} m; a length above 0 is allowed", options.edge_length));
  for (const double angle : {options.crease_angle, options.corner_angle}) {
    if (!(angle > 0))
      throw InputError(name,
                       fmt::format("creases and corners cannot be at {} rad; an angle above 0 is allowed", angle));
  }
}

// Throws InputError where there would be too many triangles, in the new mesh or on the way to it: long edges are split
// before short ones are collapsed, so that a mesh of slivers has more triangles meanwhile.
void check_size(const TriMesh& mesh, double edge_length, const std::string& name) {
  constexpr double most = 1e7;
  double triangles = 0, halves = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    triangles += area_vector(mesh, t).norm() / (std::sqrt(3.0) / 4 * edge_length * edge_length);
    for (int k = 0; k < 3; ++k)
      halves += std::floor((corner(mesh, t, k) - corner(mesh, t, (k + 1) % 3)).norm() / edge_length);
  }
  if (!(std::max(triangles, halves) <= most)) {
    throw InputError(name, fmt::format("would have about {:.1g} triangles with edges of {} m; up to {:g} are allowed",
                                       std::max(triangles, halves), edge_length, most));
  }
}

// Turns triangles over so that those of a part face as most of its area does.
void orient(TriMesh& mesh) {
  const Numbered surface{mesh, std::vector<Eigen::Index>(at(mesh.triangles.rows()), 0)};
  const Flood parts = flood(surface, neighbours_of(surface));
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    if (parts.turned[at(t)]) turn_over(mesh.triangles, t);
}

std::vector<std::array<std::int32_t, 2>> named_lines(const RemeshOptions& options, const WeldedSurface& joined,
                                                     const std::string& name) {
  std::vector<std::array<std::int32_t, 2>> edges, lines;
  if (options.lines.empty()) return lines;
  for (const TriangleEdge& side : sorted_edges(joined.mesh.triangles)) edges.push_back({side.low, side.high});
  for (const auto& [from, to] : options.lines) {
    const auto target = [&](std::int32_t v) {
      return v >= 0 && v < std::ssize(joined.vertex_target) ? joined.vertex_target[at(v)] : -1;
    };
    const auto [low, high] = std::minmax({target(from), target(to)});
    if (!std::ranges::binary_search(edges, std::array{low, high}))
      throw InputError(name, fmt::format("has no edge between vertices {} and {} to keep as a line", from, to));
    lines.push_back({low, high});
  }
  return lines;
}

// Returns how many triangles are wanted around each vertex that is a corner: one for each 60 degrees, and at least one.
std::vector<double> wanted_triangles(const TriMesh& mesh, const SurfaceFeatures& features) {
  std::vector<double> angles(at(mesh.points.rows()), 0);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (!features.is_corner[at(mesh.triangles(t, k))]) continue;
      const Vec3 a = corner(mesh, t, (k + 1) % 3) - corner(mesh, t, k),
                 b = corner(mesh, t, (k + 2) % 3) - corner(mesh, t, k);
      angles[at(mesh.triangles(t, k))] += std::atan2(a.cross(b).norm(), a.dot(b));
    }
  }
  for (double& angle : angles) angle = std::max(1.0, std::round(3 * angle / std::numbers::pi));
  return angles;
}

void run_rounds(EditableSurface& surface, const PatchProjection& projection, const std::vector<double>& wanted,
                const RemeshOptions& options) {
  const double longest = 4.0 / 3 * options.edge_length, shortest = 4.0 / 5 * options.edge_length;
  for (int round = 0; round < options.rounds; ++round) {
    split_long_edges(surface, longest);
    collapse_short_edges(surface, shortest, longest);
    flip_toward_regular(surface, wanted);
    relax(surface, projection);
  }
  // The last flips look at angles instead of counts: they do away with the few thin triangles that are left.
  constexpr int last_rounds = 3;
  for (int round = 0; round < last_rounds; ++round) {
    flip_toward_wide_angles(surface);
    relax(surface, projection);
  }
}

}  // namespace

RemeshedSurface remeshed(const TriMesh& surface, const RemeshOptions& options, const std::string& name) {
  check_options(options, name);
  WeldedSurface joined = welded(surface, 0, name);
  check_size(joined.mesh, options.edge_length, name);
  const std::vector<std::array<std::int32_t, 2>> lines = named_lines(options, joined, name);
  orient(joined.mesh);
  const double length = options.edge_length;
  const FeatureLimits limits{.crease = options.crease_angle,
                             .shortest = 2 * length,  // the creases of noise, and of what the new mesh cannot show
                             .corner = options.corner_angle,
                             .window = 0.5 * length};
  const SurfaceFeatures features = features_of(joined.mesh, lines, limits);
  const PatchProjection projection(joined.mesh, features);
  EditableSurface edited(joined.mesh, features);
  run_rounds(edited, projection, wanted_triangles(joined.mesh, features), options);
  return with_places(edited, projection, features, joined, surface);
}

}  // namespace supple
