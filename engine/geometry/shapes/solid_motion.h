// Moves the solid of a surface file as the vertices of the file move. Vertices of the solid that are in the file go
// where those go. The middle of a cap stays the mean of its rim, and a sheet that was given a thickness keeps it along
// its normals. Not here: the files of motions (files/vertex_motion.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "geometry/files/vertex_motion.h"
#include "geometry/shapes/shape.h"

namespace supple {

class SolidMotion {
 public:
  // file: the surface's OBJ file, from which `surface` was made as the options say. name: what messages call the
  // motion. Throws InputError where the motion has other vertices than the file, where the solid is one that cannot
  // follow them, and where a frame has no extent.
  SolidMotion(const ClosedSurface& surface, const std::filesystem::path& file, const SurfaceOptions& options,
              const VertexMotion& motion, const std::string& name);

  int frames() const { return static_cast<int>(frames_.size()); }
  // Returns the solid at a time in frames; between two frames, each vertex moves evenly and straight. Before the first
  // frame it is that of the first one, and after the last frame that of the last one.
  std::shared_ptr<const TriangleSolid> solid_at(double frame) const;
  // Returns the vertices of that solid, in its order [m].
  Positions points_at(double frame) const;
  // Returns the longest way of a vertex from one frame to the next [m].
  double longest_way() const;

 private:
  struct CapMiddle {  // a vertex in the middle of those around it
    Eigen::Index vertex;
    std::vector<std::int32_t> rim;  // vertices of the file
  };
  struct Beside {  // a vertex that keeps its place beside one of the file, in axes that turn with it
    Eigen::Index vertex;
    std::int32_t near, next;  // vertices of the file: the one that it lies beside, and a neighbour of that one
    Vec3 offset;              // [m]
  };

  void bind(const Positions& vertices, const TriMesh& read, double close, double thickness, const std::string& name);
  Mat3 axes_at(const Positions& file, const Positions& normals, const Beside& beside) const;
  Positions normals_of(const Positions& file) const;

  std::shared_ptr<const TriangleSolid> rest_;
  std::vector<Positions> frames_;   // by vertex of the file [m]
  Triangles triangles_;             // of the file, by its vertices
  std::vector<std::int32_t> same_;  // vertex of the file by vertex of the solid; -1: there is none
  std::vector<CapMiddle> middles_;
  std::vector<Beside> beside_;
};

}  // namespace supple
