// Finds how the surroundings of a mesh's vertices are turned and stretched: at each vertex, the mean of the deformation
// gradients of its elements, weighted by their rest volumes. The mean is linear in the positions and smooth from vertex
// to vertex. What it carries stays bounded, because its stretches are held within limits, and it never reflects.
#pragma once

#include <vector>

#include "base/threads.h"
#include "geometry/meshes/mesh.h"

namespace supple {

struct VertexFrames {
  std::vector<std::int32_t> vertex;  // by frame: its mesh vertex
  std::vector<std::int32_t> begin;   // by frame, and one more: its first term below
  std::vector<std::int32_t> corner;  // by term: a mesh vertex
  Positions gradient;                // by term: the frame is the sum of corner * gradient^T [1/m]
  Eigen::Index count() const { return static_cast<Eigen::Index>(vertex.size()); }
};

// Prepares the frames of the named vertices; each must belong to an element that has volume.
VertexFrames vertex_frames(const TetMesh& mesh, const std::vector<std::int32_t>& vertices);

// Returns the frames at the mesh's current positions. An affine motion whose stretches lie within the limits of
// held_within_limits is returned as it is.
std::vector<Mat3> frames_at(const VertexFrames& frames, const Positions& positions, Threads* threads = nullptr);

// Returns the matrix with its singular values held within [2/3, 3/2], and with a positive determinant: of a matrix that
// reflects, the direction of the smallest stretch is turned round (Irving, Teran, Fedkiw 2004, "Invertible finite
// elements").
Mat3 held_within_limits(const Mat3& gradient);

}  // namespace supple
