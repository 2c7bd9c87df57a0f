#include "render/visibility.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/disjoint_sets.h"
#include "base/error.h"

namespace supple {
namespace {

constexpr std::uint32_t most_triangles = (1u << 24) - 1;

// Triangles are cut at this many half pictures from the middle, so that the numbers of SampleBuffer hold their corners.
constexpr float reach = 3;

// A cloth is shown where it lies no deeper than this below the surface of a collider, over the cloth's size: its flat
// triangles cut into what they lie on, as deep as contact lets them and as an edge is sharp. Colliders that lie further
// in front of it along a ray than `most_along_ray` times as much hide it in any case.
constexpr double cut_in = 0.0015, most_along_ray = 6;

// Surfaces that lie on the ground count as above it.
constexpr float ground = -1e-4f;

// Returns a number for each triangle of a mesh: triangles that share a vertex have the same, which is below the number
// of vertices. A crease has separate vertices on its two sides, so such a patch is smooth. Vertices that colours split
// belong together.
std::vector<std::uint32_t> smooth_patches(const DrawMesh& mesh) {
  DisjointSets joined(mesh.occlusion.size());
  for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
    for (std::size_t k = 1; k < 3; ++k) joined.join(mesh.triangles[t + k], mesh.triangles[t]);
  }
  std::map<std::uint32_t, std::uint32_t> first_of;  // by number of DrawMesh::smooth
  for (std::uint32_t v = 0; v < mesh.smooth.size(); ++v)
    joined.join(v, first_of.try_emplace(mesh.smooth[v], v).first->second);
  std::vector<std::uint32_t> patches;
  for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3)
    patches.push_back(std::uint32_t(joined.of(mesh.triangles[t])));
  return patches;
}

double cut_into_colliders(const DrawMesh& mesh) {
  const bool cloth = mesh.two_sided && mesh.kept_clear && !mesh.ghost;
  return cloth ? cut_in * mesh.rest.diagonal() : 0;
}

// Returns the factors on the nearness of a mesh's vertices that bring them closer to the eye, as if they were higher by
// a depth [m]. They count against other meshes alone: the mesh's own folds hide each other as they lie.
std::vector<float> lifted(const std::vector<std::uint32_t>& triangles, const std::vector<float>& positions,
                          const Vec3& eye, double depth) {
  const auto place = [&positions](std::uint32_t v) {
    return Vec3(positions[3 * std::size_t(v)], positions[3 * std::size_t(v) + 1], positions[3 * std::size_t(v) + 2]);
  };
  std::vector<Vec3> normals(positions.size() / 3, Vec3::Zero());
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const Vec3 a = place(triangles[t]);
    const Vec3 normal = (place(triangles[t + 1]) - a).cross(place(triangles[t + 2]) - a);
    for (std::size_t k = t; k < t + 3; ++k) normals[triangles[k]] += normal;
  }
  std::vector<float> factors;
  for (std::uint32_t v = 0; v < normals.size(); ++v) {
    const Vec3 to_eye = eye - place(v);
    const double distance = to_eye.norm();
    const double facing = std::abs(normals[v].dot(to_eye)) / std::max(normals[v].norm() * distance, 1e-30);
    const double along = depth * std::min(most_along_ray, 1 / std::max(facing, 1e-6));
    factors.push_back(static_cast<float>(1 / (1 - std::min(0.5, along / distance))));
  }
  return factors;
}

// Returns the place from which a view is seen: the one point that it maps to no place in the picture.
Vec3 eye_of(const Eigen::Matrix4f& view) {
  Mat3 rows;
  rows << view.row(0).head<3>().cast<double>(), view.row(1).head<3>().cast<double>(),
      view.row(3).head<3>().cast<double>();
  return -rows.inverse() * Vec3(view(0, 3), view(1, 3), view(3, 3));
}

}  // namespace

Visibility::Visibility(int width, int height, int samples, const std::vector<DrawMesh>& meshes)
    : width_(width),
      height_(height),
      buffer_(width, height, samples),
      tiles_(width, height),
      full_(width, height),
      surfaces_(2 * std::size_t(width) * height) {
  SUPPLE_CHECK(std::max(width, height) * (reach + 1) / 2 * SampleBuffer::parts, <, SampleBuffer::furthest);
  renew(meshes);
}

void Visibility::renew(const std::vector<DrawMesh>& meshes) {
  patches_.clear();
  std::uint32_t vertices = 0;
  for (const DrawMesh& mesh : meshes) {
    for (const std::uint32_t patch : smooth_patches(mesh)) patches_.push_back(vertices + patch);
    vertices += static_cast<std::uint32_t>(mesh.occlusion.size());
  }
  if (patches_.size() > most_triangles) throw RunError("the scene has more than 16,777,215 triangles to draw");
}

// Empties what the last frame has written.
void Visibility::clear() {
  for (int y = 0; y < height_; ++y) {
    for (int column = 0; column < tiles_.columns(); ++column) {
      if (!tiles_.marked(column, y / Tiles::edge)) continue;
      buffer_.clear(y, column * Tiles::edge, std::min(width_, (column + 1) * Tiles::edge));
    }
  }
  tiles_.clear();
  full_.clear();
}

Visibility::WorldCorner Visibility::corner_at(const float* place, const Eigen::Matrix4f& view) const {
  const auto row = [&](int k) {
    return view(k, 0) * place[0] + view(k, 1) * place[1] + view(k, 2) * place[2] + view(k, 3);
  };
  return {row(0), row(1), row(3), place[1]};
}

ScreenCorner Visibility::on_screen(const WorldCorner& corner) const {
  const float nearness = 1 / corner.w;
  const auto parts = [nearness](float clip, int pixels) {
    return static_cast<std::int32_t>(
        std::floor((clip * nearness + 1) * (0.5f * static_cast<float>(pixels * SampleBuffer::parts)) + 0.5f));
  };
  return {parts(corner.x, width_), parts(corner.y, height_), nearness};
}

namespace {

// Returns how far a corner lies within each of the bounds of what is seen; negative beyond it.
template <class Corner>
std::array<float, 6> within(const Corner& c, float nearest) {
  const float wide = reach * c.w;
  return {c.w - nearest, c.height - ground, wide - c.x, wide + c.x, wide - c.y, wide + c.y};
}

}  // namespace

std::uint8_t Visibility::outside(const WorldCorner& corner) const {
  unsigned bits = 0;
  const std::array<float, 6> inside = within(corner, nearest_);
  for (unsigned k = 0; k < inside.size(); ++k) bits |= inside[k] < 0 ? 1u << k : 0u;
  return static_cast<std::uint8_t>(bits);
}

void Visibility::project(const std::vector<float>& positions, const Eigen::Matrix4f& view) {
  const std::size_t vertices = positions.size() / 3;
  corners_.resize(vertices);
  outside_.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    const WorldCorner corner = corner_at(&positions[3 * v], view);
    outside_[v] = outside(corner);
    if (outside_[v] == 0) corners_[v] = on_screen(corner);
  }
}

// Cuts a convex polygon at all bounds, one after the other (Sutherland and Hodgman 1974). An edge is always cut from
// its inner end, so that both triangles on it get the same corner.
void Visibility::cut(std::vector<WorldCorner>& polygon) const {
  std::vector<WorldCorner> before;
  for (std::size_t bound = 0; bound < 6 && !polygon.empty(); ++bound) {
    before.swap(polygon);
    polygon.clear();
    for (std::size_t i = 0; i < before.size(); ++i) {
      const WorldCorner &from = before[i], &to = before[(i + 1) % before.size()];
      const float here = within(from, nearest_)[bound], there = within(to, nearest_)[bound];
      if (here >= 0) polygon.push_back(from);
      if ((here >= 0) == (there >= 0)) continue;
      const WorldCorner &inner = here >= 0 ? from : to, &outer = here >= 0 ? to : from;
      const float share = std::max(here, there) / std::abs(here - there);
      const auto mixed = [&](float WorldCorner::*part) { return inner.*part + share * (outer.*part - inner.*part); };
      WorldCorner corner = {mixed(&WorldCorner::x), mixed(&WorldCorner::y), mixed(&WorldCorner::w),
                            mixed(&WorldCorner::height)};
      corner.w = std::max(corner.w, nearest_);
      polygon.push_back(corner);
    }
  }
}

void Visibility::fill(const std::array<ScreenCorner, 3>& corners, std::uint32_t number, const DrawMesh& mesh,
                      float factor) {
  // Closed bodies hide their far sides. A ghost is written into every second sample, so that half of each pixel shows
  // what lies behind.
  const SampleBuffer::Box box = factor > 0
                                    ? buffer_.fill_lifted(corners, number, factor)
                                    : buffer_.fill(corners, number, mesh.two_sided ? Facing::both : Facing::towards,
                                                   mesh.ghost ? Samples::every_second : Samples::all);
  if (box.right < box.left) return;
  for (int row = box.low / Tiles::edge; row <= box.high / Tiles::edge; ++row) {
    for (int column = box.left / Tiles::edge; column <= box.right / Tiles::edge; ++column) tiles_.mark(column, row);
  }
}

// number: the number of the mesh's first triangle, counted from one.
void Visibility::fill_mesh(const DrawMesh& mesh, const std::vector<float>& positions, const Eigen::Matrix4f& view,
                           std::uint32_t number) {
  project(positions, view);
  const std::vector<std::uint32_t>& triangles = mesh.triangles;
  const double depth = cut_into_colliders(mesh);
  const std::vector<float> factors =
      depth > 0 ? lifted(triangles, positions, eye_of(view), depth) : std::vector<float>();
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3, ++number) {
    const std::uint32_t a = triangles[t], b = triangles[t + 1], c = triangles[t + 2];
    if ((outside_[a] & outside_[b] & outside_[c]) != 0) continue;
    const float factor = factors.empty() ? 0 : (factors[a] + factors[b] + factors[c]) / 3;
    if ((outside_[a] | outside_[b] | outside_[c]) == 0) {
      fill({corners_[a], corners_[b], corners_[c]}, number, mesh, factor);
      continue;
    }
    polygon_.clear();
    for (const std::uint32_t v : {a, b, c}) polygon_.push_back(corner_at(&positions[3 * std::size_t(v)], view));
    cut(polygon_);
    const auto corner = [&](std::size_t k) { return on_screen(polygon_[k]); };
    for (std::size_t k = 2; k < polygon_.size(); ++k) fill({corner(0), corner(k - 1), corner(k)}, number, mesh, factor);
  }
}

void Visibility::find(const std::vector<DrawMesh>& meshes, const std::vector<std::vector<float>>& positions,
                      const Eigen::Matrix4f& view, double nearest, double pixel) {
  clear();
  nearest_ = static_cast<float>(nearest);
  for (const bool cloth : {false, true}) {
    std::uint32_t number = 1;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      if ((cut_into_colliders(meshes[m]) > 0) == cloth) fill_mesh(meshes[m], positions[m], view, number);
      number += static_cast<std::uint32_t>(meshes[m].triangles.size() / 3);
    }
    SUPPLE_CHECK(number, ==, patches_.size() + 1);
  }
  resolve(static_cast<float>(pixel));
}

void Visibility::resolve(float pixel) {
  for (int row = 0; row < tiles_.rows(); ++row) {
    for (int column = 0; column < tiles_.columns(); ++column) {
      if (!tiles_.marked(column, row)) continue;
      bool full = false;
      switch (buffer_.samples()) {  // a constant number makes short loops straight
        case 1: full = resolve_tile<1>(column, row, pixel); break;
        case 2: full = resolve_tile<2>(column, row, pixel); break;
        case 4: full = resolve_tile<4>(column, row, pixel); break;
        default: full = resolve_tile<8>(column, row, pixel); break;
      }
      if (full) full_.mark(column, row);
    }
  }
}

// Returns whether all samples of the tile show something.
template <int samples>
bool Visibility::resolve_tile(int column, int row, float pixel) {
  const int left = column * Tiles::edge, right = std::min(width_, left + Tiles::edge);
  const int low = row * Tiles::edge, high = std::min(height_, low + Tiles::edge);
  constexpr std::uint32_t all = ((1u << samples) - 1) << 24;
  bool full = true;
  for (int y = low; y < high; ++y) {
    const std::uint32_t* numbers = buffer_.numbers(left, y);
    const float* nearness = buffer_.nearness(left, y);
    std::uint32_t* surfaces = &surfaces_[2 * (std::size_t(y) * width_ + left)];
    for (int x = left; x < right; ++x, numbers += samples, nearness += samples, surfaces += 2) {
      bool alike = true, covered = numbers[0] != 0;
      for (int s = 1; s < samples; ++s) {
        alike = alike && numbers[s] == numbers[0];
        covered = covered && numbers[s] != 0;
      }
      full = full && covered;
      surfaces[0] = numbers[0] == 0 ? 0 : numbers[0] | all;
      surfaces[1] = 0;
      if (!alike) resolve_pixel<samples>(numbers, nearness, pixel, surfaces);
    }
  }
  return full;
}

// Samples are of one surface when they show the same smooth patch at nearly the same distance: their distances differ
// by less than six pixels. The triangle that most samples show stands for the first surface. If there is a second one,
// a third counts as the second.
template <int samples>
void Visibility::resolve_pixel(const std::uint32_t* numbers, const float* nearness, float pixel,
                               std::uint32_t* surfaces) const {
  int first = -1, most = 0;
  for (int s = 0; s < samples; ++s) {
    int alike = 0;
    for (int k = 0; k < samples; ++k) alike += numbers[k] == numbers[s] ? 1 : 0;
    const bool better = numbers[s] != 0 && alike > most;
    first = better ? s : first;
    most = better ? alike : most;
  }
  const std::uint32_t patch = patches_[numbers[first] - 1];
  surfaces[0] = numbers[first];
  surfaces[1] = 0;
  for (int s = 0; s < samples; ++s) {
    if (numbers[s] == 0) continue;
    const bool same =
        numbers[s] == numbers[first] || (patches_[numbers[s] - 1] == patch &&
                                         std::abs(nearness[s] - nearness[first]) < 6 * pixel * std::abs(nearness[s]));
    if (!same) surfaces[1] = (surfaces[1] & 0xff000000u) | numbers[s];
    surfaces[same ? 0 : 1] |= 1u << (24 + s);
  }
}

}  // namespace supple
