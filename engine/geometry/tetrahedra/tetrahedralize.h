// Makes tetrahedra from a shape by isosurface stuffing (stuffed_lattice.h), at the spacing that gives the number of
// vertices which is asked for. The result is deterministic. The method is not meant for sharp edges, which come out
// rounded at the lattice's scale (box_mesh makes boxes).
#pragma once

#include <functional>

#include "geometry/meshes/mesh.h"
#include "geometry/shapes/shape.h"

namespace supple {

struct ThicknessSample;  // geometry/triangles/surface_thickness.h

// Hears of a mesh that is made in several attempts, and judges it.
struct MeshingListener {
  // Hears the number of the attempt, from 1, and the share of it that is done, 0 to 1. Empty: nobody hears.
  std::function<void(int attempt, double share)> progress;
  // Sees each mesh of about the right size, and may throw to end the search. Empty: nobody looks.
  std::function<void(const TetMesh&)> judge;
};

// How far the number of a mesh's vertices may be from the wanted number, as a share of the wanted number.
inline constexpr double usual_miss = 0.03, swollen_miss = 0.1;

// Makes one connected manifold body with about `vertices` vertices; its regions follow the shape's tags. Throws
// InputError (naming `source`) if the shape is unbounded or empty, or too thin for that many vertices. swell: how far
// the body reaches beyond a closed surface, in spacings of the lattice: with 1/2 each part of the surface is held by
// elements, however thin it is, and parts that are nearer to each other than a spacing hang together. most_missed: by
// which share the number may be missed where no mesh comes nearer; not less than usual_miss.
TetMesh tetrahedralize(const Shape& shape, int vertices, const std::string& source,
                       const MeshingListener& listener = {}, double swell = 0, double most_missed = usual_miss);

// Makes a body as tetrahedralize() does, to within 10 % of the number, with smaller elements where the shape is thin,
// and swollen there. thickness, swollen_to: see graded_stuffing.h.
TetMesh graded_tetrahedralize(const Shape& shape, int vertices, const std::string& source,
                              const std::vector<ThicknessSample>& thickness, double swollen_to,
                              const MeshingListener& listener = {});

// Makes a box from the origin to `extent` with `cells` cells along each axis. Each cell is cut into six tetrahedra
// around one diagonal, mirrored from cell to cell so that no direction is preferred.
TetMesh box_mesh(const Vec3& extent, const Eigen::Vector3i& cells);

}  // namespace supple
