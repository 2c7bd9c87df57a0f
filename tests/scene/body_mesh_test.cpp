// Tests how many vertices a body made from a shape has, and what is said of it.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "scene/building/assemble.h"
#include "support/bodies.h"
#include "support/scene_text.h"

namespace supple {
namespace body_mesh_test {

// Makes a rod of about so many vertices.
Body rod(int vertices) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "rod.toml")
      << "[[part]]\ncapsule = { ends = [[-0.3, 0, 0], [0.3, 0, 0]], radius = 0.05 }\n";
  return assemble(test::scene_of(fmt::format("[[body]]\nname = \"rod\"\nshape = \"{}\"\nvertices = {}\n"
                                             "material = \"rubber\"\n",
                                             (folder.path / "rod.toml").string(), vertices)))
      .front();
}

TEST(BodyMesh, OfASlenderShapeHasTheNearestNumberOfVerticesAndSaysWhich) {
  for (const int wanted : {100, 750, 1000}) {
    const Body body = rod(wanted);
    const auto made = body.description.mesh.rest.rows();
    EXPECT_LT(std::abs(double(made) / wanted - 1), 0.5);
    ASSERT_EQ(body.notes.size(), 1u) << wanted;
    EXPECT_EQ(body.notes.front(),
              fmt::format("has {} vertices, the nearest number to {} of which a mesh was found", made, wanted));
  }
  EXPECT_TRUE(rod(300).notes.empty());
}

TEST(BodyMesh, OfASlenderShapeIsRefusedWhereNoNumberIsNear) {
  try {
    rod(50);
    FAIL() << "was meshed";
  } catch (const InputError& error) {
    EXPECT_NE(error.problems().front().message.find("cannot be meshed with 50 vertices: its thinnest part needs more "
                                                    "of them; "),
              std::string::npos)
        << error.problems().front().message;
  }
}

}  // namespace body_mesh_test
}  // namespace supple
