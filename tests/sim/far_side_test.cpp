// Tests what counts as a part of a body on the far side of a thin collider, and that lying on it, hanging over its rim
// and reaching around that do not.
#include "sim/measures/far_side.h"

#include <cmath>
#include <memory>

#include "geometry/meshes/cloth.h"
#include "support/contact_scene.h"

namespace supple {
namespace far_side_test {

using test::moved_to;
using test::shape_of;

constexpr double thickness = 0.001;  // of the plates [m]

Collider plate(const Vec3& half) { return {"plate", shape_of(Box{half, 0}), 0, 0}; }
const Vec3 wide(0.5, 0.5 * thickness, 0.5);

// The same as a closed surface of triangles.
Collider plate_of_triangles(const Vec3& half) {
  TetMesh box = box_mesh(2 * half, Eigen::Vector3i(3, 1, 3));
  box.rest.rowwise() -= half.transpose();
  ClosedSurface surface;
  surface.solid = std::make_shared<TriangleSolid>(TriMesh{box.rest, boundary_faces(box.tets)});
  return {"plate", shape_of(surface), 0, 0};
}

// A cube of 0.2 m that stands on a corner, whose lowest point is at y = 0.
struct Standing {
  Model model = build_model(test::cube(4));
  Positions x;

  Standing() {
    const Vec3 diagonal = Vec3::Ones().normalized();
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(diagonal, Vec3::UnitY());
    x = model.rest * turn.toRotationMatrix().transpose();
    x.col(1).array() -= x.col(1).minCoeff();
  }
  double below(const Collider& collider, double depth) const {
    return reach_on_far_side(model, collider, moved_to({0, depth, 0}), x);
  }
};

TEST(FarSide, HasTheCornerThatCameThroughAPlate) {
  const Standing cube;
  for (const Collider& collider : {plate(wide), plate_of_triangles(wide)}) {
    for (const double depth : {0.005, 0.033, 0.1})
      EXPECT_NEAR(cube.below(collider, depth), depth - 0.5 * thickness, 1e-9) << depth;
    // More than half of it: the smaller part is the upper one.
    EXPECT_NEAR(cube.below(collider, 0.3), 0.2 * std::sqrt(3) - 0.3 - 0.5 * thickness, 1e-9);
  }
}

TEST(FarSide, HasNothingOfABodyThatIsOnOneSide) {
  const Standing cube;
  for (const Collider& collider : {plate(wide), plate_of_triangles(wide)}) {
    for (const double depth : {-1.0, -0.01, -0.0006, -0.0005, -0.0003, 0.0004, 0.35, 1.0})
      EXPECT_EQ(cube.below(collider, depth), 0) << depth;
  }
  const Model lying = build_model(test::cube(4));
  for (const double over : {0.0, 0.1, 0.17}) {  // its rim stands over that of the plate
    for (const double gap : {1e-3, 0.0, -1e-5, -1e-4}) {
      const Eigen::Isometry3d pose = moved_to({0.5 + over, -0.1 - 0.5 * thickness - gap, 0});
      EXPECT_EQ(reach_on_far_side(lying, plate(wide), pose, lying.rest), 0) << over << ' ' << gap;
    }
  }
}

TEST(FarSide, IsOfThinCollidersAlone) {
  const Standing cube;
  EXPECT_EQ(cube.below(plate({0.5, 0.01, 0.5}), 0.1), 0) << "of which the depth tells";
  EXPECT_GT(cube.below(plate({0.5, 0.003, 0.5}), 0.1), 0);
}

// A body like a C, whose arms lie above and below a plate that ends within it.
TEST(FarSide, HasNothingOfABodyThatReachesAroundAPlatesRim) {
  BodyDescription body = test::cube(5);
  std::vector<char> keep(std::size_t(body.mesh.tets.rows()), 1);
  for (Eigen::Index e = 0; e < body.mesh.tets.rows(); ++e) {
    Vec3 center = Vec3::Zero();
    for (int k = 0; k < 4; ++k) center += 0.25 * body.mesh.rest.row(body.mesh.tets(e, k)).transpose();
    if (center.x() > -0.06 && std::abs(center.y()) < 0.02) keep[std::size_t(e)] = 0;
  }
  body.mesh = submesh(body.mesh, keep);
  const Model model = build_model(body);
  for (const double close : {1.0, 0.5, 0.026, 0.0245}) {  // how far the slot is open
    Positions x = model.rest;
    for (int v = 0; v < model.vertices; ++v) {
      if (std::abs(x(v, 1)) < 0.021) x(v, 1) *= close;
    }
    EXPECT_EQ(reach_on_far_side(model, plate({0.155, 0.5 * thickness, 0.5}), moved_to({0.1, 0, 0}), x), 0) << close;
  }
}

// A cloth over the upper rim of a plate that stands: its edges cut the rim short.
TEST(FarSide, HasNothingOfAClothThatHangsOverARim) {
  BodyDescription cloth = test::spring_net(16);
  cloth.surface = cloth_grid({0.4, 0.4}, {16, 16}).surface.triangles;
  const Model model = build_model(cloth);
  const Vec3 center = bounds_of(model.rest).center();
  Positions x = model.rest.rowwise() - center.transpose();
  x.col(0).array() += 0.007;                  // the rim is between vertices
  for (int v = 0; v < model.vertices; ++v) {  // folded by nearly half a turn
    x(v, 2) = x(v, 1);
    x(v, 1) = -0.95 * std::abs(x(v, 0)) + 0.001;
    x(v, 0) *= 0.3;
  }
  const Collider standing = plate({0.5 * thickness, 0.3, 0.5});
  EXPECT_EQ(reach_on_far_side(model, standing, moved_to({0, -0.3, 0}), x), 0);
  // Where the plate comes from below, it is through the whole cloth.
  Positions flat = model.rest.rowwise() - center.transpose();
  EXPECT_NEAR(reach_on_far_side(model, standing, moved_to({0.051, 0, 0}), flat), 0.149 - 0.5 * thickness, 1e-9);
}

}  // namespace far_side_test
}  // namespace supple
