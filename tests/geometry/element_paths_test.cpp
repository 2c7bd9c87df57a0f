// Tests straight lines through the elements of a box, whose ends are found by barycentric coordinates too.
#include "geometry/tetrahedra/element_paths.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "geometry/meshes/mesh.h"
#include "geometry/tetrahedra/tetrahedralize.h"

namespace supple {
namespace element_paths_test {

struct Box {
  TetMesh mesh = box_mesh(Vec3(1, 1, 1), {4, 4, 4});
  Triangles triangles = boundary_faces(mesh.tets);
  ElementPaths paths{mesh.tets, triangles, mesh.rest};

  Vec3 center_of(std::int32_t t) const {
    return (mesh.rest.row(triangles(t, 0)) + mesh.rest.row(triangles(t, 1)) + mesh.rest.row(triangles(t, 2)))
               .transpose() /
           3;
  }
  bool contains(std::int32_t element, const Vec3& p) const {
    Mat3 edges;
    const Vec3 first = mesh.rest.row(mesh.tets(element, 0));
    for (int k = 0; k < 3; ++k) edges.col(k) = mesh.rest.row(mesh.tets(element, k + 1)).transpose() - first;
    const Vec3 shares = edges.inverse() * (p - first);
    return shares.minCoeff() > -1e-9 && shares.sum() < 1 + 1e-9;
  }
};

TEST(ElementPaths, LeadFromEachFaceToEachPlaceInside) {
  const Box box;
  const Bounds around = bounds_of(box.mesh.rest);
  for (std::int32_t t = 0; t < box.triangles.rows(); t += 7) {
    for (const Vec3& share : {Vec3(0.21, 0.33, 0.72), Vec3(0.5, 0.5, 0.5), Vec3(0.9, 0.11, 0.4)}) {
      const Vec3 to = around.lower + share.cwiseProduct(around.extent());
      const auto element = box.paths.element_at_end(box.mesh.rest, t, box.center_of(t), to);
      ASSERT_TRUE(element) << t;
      EXPECT_TRUE(box.contains(*element, to)) << t;
    }
  }
}

TEST(ElementPaths, EndWhereTheyLeaveTheElementsOrMeetAnInvertedOne) {
  const Box box;
  const Vec3 outside = bounds_of(box.mesh.rest).upper + Vec3(0.1, 0.2, 0.3);
  Positions mirrored = box.mesh.rest;
  mirrored.col(0) *= -1;
  for (std::int32_t t = 0; t < box.triangles.rows(); t += 5) {
    EXPECT_FALSE(box.paths.element_at_end(box.mesh.rest, t, box.center_of(t), outside));
    EXPECT_FALSE(box.paths.element_at_end(mirrored, t, box.center_of(t), Vec3::Zero()));
  }
  EXPECT_EQ(box.paths.inverted_share(mirrored), 1);
  EXPECT_EQ(box.paths.inverted_share(box.mesh.rest), 0);
}

TEST(ElementPaths, KnowNeighboursAndCollapsedElements) {
  const Box box;
  for (std::int32_t v = 0; v < box.mesh.rest.rows(); v += 9) {
    for (std::int32_t w = 0; w < box.mesh.rest.rows(); w += 4) {
      bool share = v == w;
      for (Eigen::Index e = 0; e < box.mesh.tets.rows(); ++e)
        share |= (box.mesh.tets.row(e).array() == v).any() && (box.mesh.tets.row(e).array() == w).any();
      EXPECT_EQ(box.paths.are_neighbours(v, w), share) << v << " " << w;
    }
    EXPECT_FALSE(box.paths.is_collapsed_at(box.mesh.rest, v));
    Positions pressed = box.mesh.rest;
    pressed.col(1) *= 0.09;
    EXPECT_TRUE(box.paths.is_collapsed_at(pressed, v));
    pressed.col(1) *= 0.11 / 0.09;
    EXPECT_FALSE(box.paths.is_collapsed_at(pressed, v));
  }
}

}  // namespace element_paths_test
}  // namespace supple
