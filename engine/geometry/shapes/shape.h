// A shape is a solid described by a signed distance field: primitives, rigid transforms, mirrored copies, unions, cuts
// and smooth blends. One description serves for meshing at any resolution, for collisions and for drawing. Gradients
// and closest points are computed in shape_closest.cpp. Files (scene/) and meshes (mesh.h) lie elsewhere. The distance
// is negative inside. Outside, it is exact for single primitives other than the ellipsoid, and a bound of the right
// sign after blends and cuts; its zero set is always exact.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/names.h"
#include "geometry/files/source_file.h"
#include "geometry/meshes/pose.h"
#include "geometry/solids/surface_point.h"

namespace supple {

class TriangleSolid;

struct Sphere {
  double radius;
};
struct Ellipsoid {
  Vec3 radii;
};
struct Capsule {  // the points within `radius` of a segment
  Vec3 from, to;
  double radius;
};
struct RoundCone {  // the convex hull of two spheres
  Vec3 from, to;
  double from_radius, to_radius;
};
struct Box {  // edges rounded by `round`, inside the given extent
  Vec3 half;
  double round;
};
struct Cylinder {  // around the y axis; edges rounded by `round`
  double radius, half_height, round;
};
struct Torus {  // around the y axis
  double radius, tube;
};
struct HalfSpace {  // the side that the unit normal points away from
  Vec3 normal;
  double offset;
};

struct ClosedSurface {  // triangles from a file
  std::shared_ptr<const TriangleSolid> solid;
  std::shared_ptr<const TriMesh> drawn = nullptr;  // what is seen of it; null: the solid's own triangles
};

struct ShapePart;
struct ShapeGroup {
  std::vector<ShapePart> parts;
};

using Primitive =
    std::variant<Sphere, Ellipsoid, Capsule, RoundCone, Box, Cylinder, Torus, HalfSpace, ClosedSurface, ShapeGroup>;

enum class Combine { add, cut, intersect };
template <>
struct Names<Combine> {
  static constexpr std::array table = {Name{Combine::add, "add"}, Name{Combine::cut, "cut"},
                                       Name{Combine::intersect, "intersect"}};
};

// Describes one step in building a shape: the field so far is combined with this part.
struct ShapePart {
  Primitive primitive;
  Eigen::Isometry3d to_local = no_motion();  // from the parent's frame
  double scale = 1;                          // local lengths times scale are lengths in the parent's frame
  bool mirror_x = false;                     // whether a copy lies at x -> -x of the parent's frame
  Combine combine = Combine::add;
  double blend = 0;  // width over which the surfaces blend into each other [m]
  int region = 0;    // tag of the elements inside; 0 is untagged

  // Returns the distance of this part alone, in its parent's frame.
  double distance(const Vec3& point) const;
};

double distance(const Primitive& primitive, const Vec3& point);

// Blends two fields: `value` is the smaller one, lowered by at most blend / 4 where they are equal (a quadratic
// polynomial smooth minimum); `share` is the share of b in the gradient.
struct Blended {
  double value;
  double share;
};
Blended smooth_min(double a, double b, double blend);

// A layer of colour lies on the drawn skin where its field is negative. It is never part of the geometry.
struct PaintLayer {
  std::string name;
  Vec3 color;    // sRGB, 0 to 1
  double gloss;  // 0 matt to 1 wet
  double soft;   // width of its soft border [m]
  ShapeGroup area;
};

struct Shape {
  ShapeGroup root;
  std::vector<std::string> regions = {""};  // names by tag; the first is untagged
  Vec3 color = Vec3(0.8, 0.6, 0.4);         // sRGB colour where no layer lies
  std::vector<PaintLayer> paint;            // later layers lie over earlier ones
  std::vector<std::string> notes;           // remarks made while its files were read
  std::vector<SourceFile> files;            // the files that it was read from

  double distance(const Vec3& point) const;
  Vec3 gradient(const Vec3& point, double step) const;  // central differences over +-step
  Bounds bounds() const;                                // conservative; unbounded shapes give an extent above 1e6

  // Returns the surface's closest point. It is exact for single primitives. For other shapes, it is found from the
  // field by iteration: a point of the surface whose normal leads to `point` (except at edges), and the closest such
  // point where the depth is below the surface's radius of curvature. Where the field's slope leads to no surface, as
  // between parts that are cut off from each other, the distance and normal are the field's.
  SurfacePoint closest(const Vec3& point) const;

  // Returns a factor c such that the distance to the surface is at least c |distance(point)|; it is 1 except for
  // ellipsoids.
  double certainty() const;

  // Returns a length such that a straight path shorter than twice this length cannot lead through the solid, except
  // across its edges; 0 where no such length is known.
  double half_thickness() const;
  // Returns the same length, except for a closed surface: its half_thickness() is 0, and here it has half the thickness
  // that all but its thinnest twentieth have at least [m].
  double usual_half_thickness() const;

  // Returns the tag of the last tagged part that holds the point; outside all parts, the tag of the nearest one.
  int region(const Vec3& point) const;
};

double distance(const ShapeGroup& group, const Vec3& point);

// Returns the solid inside a closed surface.
Shape shape_of(TriMesh closed_surface);

}  // namespace supple
