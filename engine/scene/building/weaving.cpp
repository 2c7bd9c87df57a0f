#include "scene/building/weaving.h"

#include "scene/building/cloth_cut.h"

namespace supple {
namespace {

// Makes the springs of cloth, with their rest lengths in the world.
void weave_springs(Body& body) {
  const ClothDef& def = *body.def.cloth;
  BodyDescription& description = body.description;
  description.springs.clear();
  const auto join = [&](const std::vector<VertexPair>& pairs, double stiffness) {
    if (stiffness <= 0) return;
    for (const auto& [from, to] : pairs) {
      const double length = (description.mesh.rest.row(from) - description.mesh.rest.row(to)).norm();
      description.springs.push_back({from, to, length, stiffness});
    }
  };
  join(body.cloth.edges, def.stretch);
  join(body.cloth.diagonals, def.shear);
  join(body.cloth.bends, def.bend);
}

// Lays each triangle flat as it stands in the world. The warp is the projection of the grain onto the triangle's plane
// or, where the plane is across the grain, the direction of the first edge.
void weave_triangles(Body& body) {
  const ClothDef& def = *body.def.cloth;
  BodyDescription& description = body.description;
  const Vec3 grain = (body.placement.linear() * def.grain).normalized();
  description.fabric = def.fabric->fabric;
  description.curved = def.curved;
  description.cloth.clear();
  const Triangles& triangles = body.cloth.surface.triangles;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto corner = [&](int k) -> Vec3 { return description.mesh.rest.row(triangles(t, k)); };
    const Vec3 first = corner(1) - corner(0), second = corner(2) - corner(0);
    const Vec3 normal = first.cross(second).normalized();
    Vec3 warp = grain - normal.dot(grain) * normal;
    if (warp.norm() < 1e-3) warp = first;
    warp.normalize();
    const Vec3 weft = normal.cross(warp);
    description.cloth.push_back({{triangles(t, 0), triangles(t, 1), triangles(t, 2)},
                                 {first.dot(warp), second.dot(warp), first.dot(weft), second.dot(weft)}});
  }
}

// Lays each triangle as it lies in the texture. The warp is the grain, whose first two numbers are along u and v. A
// triangle that is mirrored there is laid as its mirror image, the same cloth seen from its back.
void weave_cut(Body& body) {
  const ClothDef& def = *body.def.cloth;
  BodyDescription& description = body.description;
  const double scale = cut_scale(body);
  const Eigen::Vector2d warp = def.grain.head<2>().normalized(), weft(-warp.y(), warp.x());
  description.fabric = def.fabric->fabric;
  description.cloth.clear();
  const Triangles& triangles = body.cloth.surface.triangles;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto& at = body.flat[std::size_t(t)];
    const Eigen::Vector2d first = scale * (at[1] - at[0]), second = scale * (at[2] - at[0]);
    const double side = first.x() * second.y() < first.y() * second.x() ? -1 : 1;
    description.cloth.push_back({{triangles(t, 0), triangles(t, 1), triangles(t, 2)},
                                 {first.dot(warp), second.dot(warp), side * first.dot(weft), side * second.dot(weft)}});
  }
}

// Gives each vertex a third of the area that its triangles have at rest [m^2].
std::vector<double> areas_at_rest(const Body& body) {
  const BodyDescription& description = body.description;
  if (body.flat.empty()) return vertex_areas({description.mesh.rest, body.cloth.surface.triangles});
  std::vector<double> areas(std::size_t(description.mesh.rest.rows()), 0.0);
  for (const FlatTriangle& triangle : description.cloth)
    for (const std::int32_t v : triangle.corner) areas[std::size_t(v)] += triangle.area() / 3;
  return areas;
}

}  // namespace

void weave(Body& body) {
  const BodyDef& def = body.def;
  BodyDescription& description = body.description;
  const ClothMesh& cloth = body.cloth;
  description.surface = cloth.surface.triangles;
  if (!body.flat.empty()) {
    weave_cut(body);
  } else if (def.cloth->fabric) {
    weave_triangles(body);
  } else {
    weave_springs(body);
  }
  description.point_mass = areas_at_rest(body);
  double area = 0;
  for (const double share : description.point_mass) area += share;
  const double density = def.total_mass ? *def.total_mass / area : def.body_density();
  for (double& mass : description.point_mass) mass *= density;
}

}  // namespace supple
