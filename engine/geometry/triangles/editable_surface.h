// Holds a triangle mesh that changes: edges are split, collapsed and flipped, and vertices move. Edges may have any
// number of triangles; lines that must stay, and the patches between them, are those of feature_lines.h. Which edge is
// changed, and where vertices go, is decided in remesh_rounds.cpp. Each change is refused that would turn a
// triangle over, make one much worse than those around it, or change how the surface hangs together.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/triangles/feature_lines.h"

namespace supple {

class EditableSurface {
 public:
  struct Vertex {
    Vec3 x;                    // position [m]
    std::int32_t line = -1;    // the line it lies on; -1: none, or it is a corner
    std::int32_t corner = -1;  // the vertex of the input that it stays at; -1: it is no corner
    double along = 0;          // of a vertex on a line: its distance from the line's start [m]
    std::int32_t near = -1;    // of other vertices: the triangle of the input that it is on, as far as known
    bool is_free() const { return line < 0 && corner < 0; }
  };
  struct Triangle {
    std::array<std::int32_t, 3> corners;  // the first one is -1 where the triangle was removed
    std::array<std::int32_t, 3> lines;    // by side (0: corner 0 to 1): the line it is part of; -1: none
    std::int32_t patch;
    bool is_gone() const { return corners[0] < 0; }
    int place_of(std::int32_t vertex) const { return corners[0] == vertex ? 0 : (corners[1] == vertex ? 1 : 2); }
    // Returns the side that joins two of its vertices.
    int side_of(std::int32_t a, std::int32_t b) const {
      return corners[1] != a && corners[1] != b ? 2 : (corners[2] != a && corners[2] != b ? 0 : 1);
    }
  };

  // Starts with the mesh that the features belong to. Both must outlive this object.
  EditableSurface(const TriMesh& mesh, const SurfaceFeatures& features);

  const std::vector<Vertex>& vertices() const { return vertices_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const Vertex& vertex(std::int32_t v) const { return vertices_[std::size_t(v)]; }
  const Triangle& triangle(std::int32_t t) const { return triangles_[std::size_t(t)]; }
  const std::vector<std::int32_t>& around(std::int32_t vertex) const { return around_[std::size_t(vertex)]; }
  double length(std::int32_t a, std::int32_t b) const { return (vertex(a).x - vertex(b).x).norm(); }

  // Returns the line that the edge between two vertices of a triangle is part of; -1: none.
  std::int32_t line_between(std::int32_t a, std::int32_t b, std::int32_t t) const;
  // Lists the triangles that have both vertices a and b.
  void triangles_at(std::int32_t a, std::int32_t b, std::vector<std::int32_t>& found) const;
  // Lists the other ends of a vertex's edges, in increasing order.
  void neighbours(std::int32_t vertex, std::vector<std::int32_t>& found) const;

  // Puts a vertex into the middle of an edge; the middle of a part of a line is taken along the line. Returns the new
  // vertex; nothing: the split was refused.
  std::optional<std::int32_t> split(std::int32_t a, std::int32_t b);

  // Makes one vertex of the two of an edge, and removes the triangles at the edge. Where both may move, the new vertex
  // lies in the middle, or at one of the two if the middle is refused. Returns the vertex that is left; nothing: the
  // collapse was refused, as it also is where an edge would be longer than `longest` [m].
  std::optional<std::int32_t> collapse(std::int32_t a, std::int32_t b, double longest);

  // Describes two triangles of a patch that share an edge on no line: (a, b, c) and (b, a, d).
  struct Pair {
    std::int32_t first, second;  // the triangles
    std::int32_t a, b, c, d;
  };
  // Returns the pair at a side of a triangle, of which the triangle is the first. Returns nothing where the side is on
  // a line, and where it runs from the higher to the lower vertex, so that each pair is found at one of its two
  // triangles only.
  std::optional<Pair> pair_at(std::int32_t t, int side) const;
  // Replaces the edge from a to b by one from c to d. Tells whether it did.
  bool flip(const Pair& pair);

  // Moves a vertex unless this turns a triangle over or makes one much worse than those around it. Tells whether it
  // did.
  bool move(std::int32_t v, const Vertex& to);

  // Returns the distance of a vertex from the start of a line that it lies on or ends, along the line [m].
  double along(std::int32_t line, std::int32_t v) const;
  // Returns a vertex on a line, at a distance from the line's start [m].
  Vertex on_line(std::int32_t line, double distance) const;

 private:
  Triangle& tri(std::int32_t t) { return triangles_[std::size_t(t)]; }
  Vertex middle(std::int32_t a, std::int32_t b, std::int32_t line) const;
  void halve(std::int32_t t, std::int32_t a, std::int32_t b, std::int32_t middle);
  bool keeps_sides(const std::vector<std::int32_t>& ring, std::int32_t a, std::int32_t b, const Vec3& to) const;
  std::vector<Vertex> merged_places(std::int32_t a, std::int32_t b, std::int32_t line) const;
  bool keeps_topology(std::int32_t a, std::int32_t b, const std::vector<std::int32_t>& between) const;
  bool may_merge(std::int32_t a, std::int32_t b, const Vec3& to, double longest) const;
  void merge(std::int32_t kept, std::int32_t gone, const std::vector<std::int32_t>& between);
  void drop(std::int32_t vertex, std::int32_t triangle);

  const TriMesh& mesh_;
  const SurfaceFeatures& features_;
  std::vector<Vertex> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<std::int32_t>> around_;  // by vertex: its triangles
};

}  // namespace supple
