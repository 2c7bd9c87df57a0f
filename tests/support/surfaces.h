// Provides closed triangle surfaces whose inside is known by formula.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "geometry/meshes/mesh.h"

namespace supple::test {

// Makes a torus around the y axis of 2 * around * across triangles.
inline TriMesh torus_surface(double radius, double tube, int around, int across) {
  TriMesh mesh;
  mesh.points.resize(around * across, 3);
  mesh.triangles.resize(2 * around * across, 3);
  const auto vertex = [&](int i, int j) { return std::int32_t((i % around) * across + j % across); };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double s = 2 * std::numbers::pi * i / around, t = 2 * std::numbers::pi * j / across;
      const double r = radius + tube * std::cos(t);
      mesh.points.row(vertex(i, j)) << r * std::cos(s), tube * std::sin(t), r * std::sin(s);
      const int face = 2 * (i * across + j);
      mesh.triangles.row(face) << vertex(i, j), vertex(i, j + 1), vertex(i + 1, j);
      mesh.triangles.row(face + 1) << vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1);
    }
  }
  return mesh;
}

// Makes a sphere of rings of latitude and two poles, with 2 * around * (rings - 1) triangles.
inline TriMesh sphere_surface(double radius, int around, int rings) {
  TriMesh mesh;
  const int middle = rings - 1;
  mesh.points.resize(around * middle + 2, 3);
  mesh.triangles.resize(2 * around * middle, 3);
  const auto south = std::int32_t(around * middle), north = south + 1;
  mesh.points.row(south) << 0, -radius, 0;
  mesh.points.row(north) << 0, radius, 0;
  const auto vertex = [&](int ring, int i) { return std::int32_t(ring * around + i % around); };
  Eigen::Index face = 0;
  for (int ring = 0; ring < middle; ++ring) {
    const double t = std::numbers::pi * (ring + 1) / rings;
    for (int i = 0; i < around; ++i) {
      const double s = 2 * std::numbers::pi * i / around;
      mesh.points.row(vertex(ring, i)) << radius * std::sin(t) * std::cos(s), -radius * std::cos(t),
          radius * std::sin(t) * std::sin(s);
      if (ring == 0) mesh.triangles.row(face++) << south, vertex(0, i), vertex(0, i + 1);
      if (ring + 1 == middle) {
        mesh.triangles.row(face++) << north, vertex(ring, i + 1), vertex(ring, i);
      } else {
        mesh.triangles.row(face++) << vertex(ring, i), vertex(ring + 1, i), vertex(ring, i + 1);
        mesh.triangles.row(face++) << vertex(ring, i + 1), vertex(ring + 1, i), vertex(ring + 1, i + 1);
      }
    }
  }
  return mesh;
}

// Makes a box of twelve triangles around the origin.
inline TriMesh box_surface(const Vec3& half) {
  TriMesh mesh;
  mesh.points.resize(8, 3);
  for (int v = 0; v < 8; ++v)
    mesh.points.row(v) << (v & 1 ? half.x() : -half.x()), (v & 2 ? half.y() : -half.y()),
        (v & 4 ? half.z() : -half.z());
  mesh.triangles.resize(12, 3);
  mesh.triangles << 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7,
      4, 7, 6;
  return mesh;
}

inline TriMesh moved(TriMesh mesh, const Vec3& by) {
  mesh.points.rowwise() += by.transpose();
  return mesh;
}

inline TriMesh inside_out(TriMesh mesh) {
  mesh.triangles.col(1).swap(mesh.triangles.col(2));
  return mesh;
}

inline TriMesh together(const TriMesh& a, const TriMesh& b) {
  TriMesh both;
  both.points.resize(a.points.rows() + b.points.rows(), 3);
  both.points << a.points, b.points;
  both.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
  both.triangles << a.triangles, (b.triangles.array() + std::int32_t(a.points.rows())).matrix();
  return both;
}

inline TriMesh without_triangle(const TriMesh& mesh, Eigen::Index triangle) {
  TriMesh rest{mesh.points, Triangles(mesh.triangles.rows() - 1, 3)};
  rest.triangles << mesh.triangles.topRows(triangle), mesh.triangles.bottomRows(rest.triangles.rows() - triangle);
  return rest;
}

// Computes six times the volume that the triangles enclose.
inline double six_volumes(const TriMesh& mesh) {
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    Mat3 corners;
    for (int k = 0; k < 3; ++k) corners.row(k) = mesh.points.row(mesh.triangles(t, k));
    sum += corners.determinant();
  }
  return sum;
}

// Returns the surface as an OBJ file says it.
inline std::string obj_text(const TriMesh& mesh) {
  std::string text;
  for (const auto& p : mesh.points.rowwise()) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  for (const auto& t : mesh.triangles.rowwise()) text += fmt::format("f {} {} {}\n", t.x() + 1, t.y() + 1, t.z() + 1);
  return text;
}

}  // namespace supple::test
