// Tests that meshes made of shapes and surfaces are found again where they were kept, with what was said of them.
#include "geometry/tetrahedra/meshing.h"

#include <gtest/gtest.h>

#include "geometry/tetrahedra/tetrahedralize.h"
#include "support/bodies.h"
#include "support/surfaces.h"

namespace supple {
namespace meshing_test {

TEST(MadeMesh, IsTheSameFromItsBytesWithItsNotes) {
  const MadeMesh made{box_mesh(Vec3(1, 2, 3), {1, 2, 1}), {"first", "second"}};
  const auto again = made_mesh_from(bytes_of(made));
  ASSERT_TRUE(again);
  EXPECT_EQ(again->mesh.rest, made.mesh.rest);
  EXPECT_EQ(again->mesh.tets, made.mesh.tets);
  EXPECT_EQ(again->notes, made.notes);
  EXPECT_TRUE(made_mesh_from(bytes_of(MadeMesh{made.mesh, {}}))->notes.empty());
  EXPECT_FALSE(made_mesh_from("neither"));
  EXPECT_FALSE(made_mesh_from(std::string("a note without an end") + std::string(25, '\0')));
  EXPECT_FALSE(made_mesh_from(bytes_of(made).substr(0, 40)));
}

// Counts how often somebody hears that a mesh is being made.
struct CountedWork {
  const test::TemporaryFolder folder;
  int told = 0;
  const SlowWork work{UserCache(folder.path / "kept", 10'000'000), [this](const std::string&) { ++told; }};
};

void expect_same(const MadeMesh& a, const MadeMesh& b) {
  EXPECT_EQ(a.mesh.rest, b.mesh.rest);
  EXPECT_EQ(a.mesh.tets, b.mesh.tets);
  EXPECT_EQ(a.mesh.regions, b.mesh.regions);
  EXPECT_EQ(a.notes, b.notes);
}

TEST(Meshing, OfAShapeIsKeptByItsContentAndItsNumberOfVertices) {
  CountedWork counted;
  Shape rod;
  rod.root.parts.emplace_back().primitive = Capsule{Vec3(-0.3, 0, 0), Vec3(0.3, 0, 0), 0.05};
  const MadeMesh made = mesh_of_shape(rod, {100, "rod", "a"}, counted.work);
  ASSERT_EQ(made.notes.size(), 1u);
  EXPECT_NE(made.notes.front().find("the nearest number to 100"), std::string::npos) << made.notes.front();
  const int told = counted.told;
  EXPECT_GT(told, 0);
  expect_same(mesh_of_shape(rod, {100, "the rod under another name", "a"}, counted.work), made);
  EXPECT_EQ(counted.told, told);
  mesh_of_shape(rod, {100, "rod", "b"}, counted.work);
  EXPECT_GT(counted.told, told);
}

TEST(Meshing, OfASurfaceIsKeptWithWhatIsSaidOfIt) {
  CountedWork counted;
  const SolidSurface plate{test::box_surface(Vec3(1, 1e-3, 0.5)), {}};
  const MadeMesh made = mesh_of_surface({plate, false}, {600, "plate", "a"}, counted.work);
  ASSERT_EQ(made.notes.size(), 2u);
  EXPECT_NE(made.notes[0].find("thinner than an element of 600 vertices"), std::string::npos) << made.notes[0];
  const int told = counted.told;
  EXPECT_GT(told, 0);
  expect_same(mesh_of_surface({plate, false}, {600, "plate", "a"}, counted.work), made);
  EXPECT_EQ(counted.told, told);
}

}  // namespace meshing_test
}  // namespace supple
