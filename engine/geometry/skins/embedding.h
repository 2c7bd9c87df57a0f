// Carries a skin by the elements of a mesh. A point inside an element keeps its barycentric place there. A point
// outside all elements follows a mean of mesh vertices, and the offset from their mean at rest turns and stretches with
// them (vertex_frames.h): exactly under an affine motion of moderate stretch, and boundedly whatever elements do.
#pragma once

#include <array>

#include "geometry/meshes/mesh.h"
#include "geometry/meshes/vertex_frames.h"

namespace supple {

// Says by how much a frame of Embedding::frames counts for a point.
struct FrameShare {
  std::int64_t frame;  // 64 bits, as the share, so that there is no padding and lists are kept byte by byte
  double share;        // not negative
};

struct Embedding {
  // The element of each point and its barycentric weights, n x 4. They carry the points inside.
  Tetrahedra corners;
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> weights;
  std::vector<std::int32_t> begin;  // by point, and one more: its first share below; a point inside has none
  std::vector<FrameShare> shares;   // those of a point sum to 1
  Positions offset;                 // by point, at rest, from the mean of its frames' vertices; inside: 0 [m]
  VertexFrames frames;

  Eigen::Index points() const { return corners.rows(); }
  bool outside(Eigen::Index point) const { return begin[std::size_t(point)] < begin[std::size_t(point) + 1]; }
};

// Embeds the vertices of a skin in a mesh at rest. Parts of the skin that are near but not joined by its edges do not
// follow each other's elements.
Embedding embed(const TriMesh& skin, const TetMesh& mesh);

// Embeds a skin that has got more vertices, each in the middle between two others. ends: by new vertex, the two between
// which it lies; some of these may be earlier new ones. A new vertex that lies in an element follows the element,
// unless both of its ends are outside. Otherwise it follows the mean of what carries its ends. It need not lie on the
// line between them. points: all vertices of the skin at rest, n x 3, in the frame of `mesh` [m].
Embedding with_middles(const Embedding& embedding, const Positions& points,
                       const std::vector<std::array<std::int32_t, 2>>& ends, const TetMesh& mesh);

// Returns the place of an embedded point at the mesh's current positions. frames: what frames_at() returns for these.
Vec3 embedded_point(const Embedding& embedding, Eigen::Index point, const Positions& mesh_positions,
                    const std::vector<Mat3>& frames);

// Returns the value at an embedded point of a field that is given by mesh vertex: the mean of the values at those mesh
// vertices that carry the point, so that it does not lie beyond them.
double embedded_value(const Embedding& embedding, Eigen::Index point, const std::vector<double>& by_vertex);

// Returns the places of all points, n x 3 [m].
Positions embedded_points(const Embedding& embedding, const Positions& mesh_positions);

// Makes the embedding one of a mesh and a skin that are `scale` times as large.
void scale_lengths(Embedding& embedding, double scale);

// Keeps the points with the given numbers alone, in this order; the numbers must ascend.
void keep_points(Embedding& embedding, const std::vector<std::int32_t>& kept);

// Says how much of a skin lies outside all elements.
struct OutsideShare {
  double share = 0;  // of the skin's vertices, 0 to 1
  Eigen::Index furthest_point = -1;
  double furthest = 0;  // the largest distance between a vertex and the mean of what carries it, at rest [m]
};
OutsideShare outside_share(const Embedding& embedding);

}  // namespace supple
