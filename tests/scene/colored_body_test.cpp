// Tests whose colours a body from a surface has: its file's, or its own.
#include <gtest/gtest.h>

#include "scene/building/drawn_body.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"
#include "support/colored_files.h"
#include "support/places.h"
#include "support/scene_text.h"

namespace supple {
namespace colored_body_test {

class ColoredBody : public ::testing::Test {
 protected:
  ColoredBody() {
    const TriMesh ball = test::sphere_surface(0.1, 16, 8);
    test::write_text(folder_.path / "red.ply", test::ply_text(ball, [](const Vec3&) { return std::array{255, 0, 0}; }));
    test::write_text(folder_.path / "plain.obj", test::obj_text(ball));
  }
  std::vector<Body> bodies_of(const std::string& keys) const {
    test::write_text(folder_.path / "s.toml", "[[body]]\nmaterial = \"jelly\"\nvertices = 200\n" + keys);
    return assemble(load_scene(folder_.path / "s.toml", test::assets, {}));
  }
  // Tells whether the body is drawn in the red of its file.
  bool is_red(const std::string& keys) const {
    const std::vector<DrawnBody> drawn = drawn_bodies(bodies_of(keys));
    const std::vector<SurfaceColor>& colors = drawn.front().skin.color;
    for (const SurfaceColor& color : colors)
      EXPECT_TRUE(color.red == 1 && color.green == 0 && color.blue == 0 && color.texture == -1);
    return !colors.empty();
  }
  test::TemporaryFolder folder_;
};

TEST_F(ColoredBody, HasTheColoursOfItsFileUnlessItHasItsOwn) {
  EXPECT_TRUE(is_red("surface = \"red.ply\"\n"));
  EXPECT_FALSE(is_red("surface = \"red.ply\"\ncolor = [0, 0, 1]\n"));
  EXPECT_FALSE(is_red("surface = \"red.ply\"\ncolors = \"body\"\n"));
  EXPECT_TRUE(is_red("surface = \"red.ply\"\ncolors = \"file\"\ncolor = [0, 0, 1]\n"));
  EXPECT_FALSE(is_red("surface = \"plain.obj\"\n"));
}

TEST_F(ColoredBody, BodiesOfOneFileMayDiffer) {
  const std::vector<DrawnBody> drawn =
      drawn_bodies(bodies_of("surface = \"red.ply\"\nname = \"a\"\n[[body]]\nmaterial = \"jelly\"\nvertices = 200\n"
                             "surface = \"red.ply\"\nname = \"b\"\ncolors = \"body\"\n"));
  ASSERT_EQ(drawn.size(), 2u);
  EXPECT_FALSE(drawn[0].skin.color.empty());
  EXPECT_TRUE(drawn[1].skin.color.empty());
}

TEST_F(ColoredBody, HearsThatItsFileHasNone) {
  const std::vector<Body> bodies = bodies_of("surface = \"plain.obj\"\ncolors = \"file\"\n");
  ASSERT_EQ(bodies.front().notes.size(), 1u);
  EXPECT_EQ(bodies.front().notes[0], "the file has no colours (colors = \"file\"): the body's own is drawn");
  EXPECT_TRUE(bodies_of("surface = \"red.ply\"\ncolors = \"file\"\n").front().notes.empty());
}

// Tetrahedra do not depend on colours, what is drawn does.
TEST_F(ColoredBody, ColoursAreASourceOfTheFilmOnlyWhereTheyAreDrawn) {
  EXPECT_EQ(bodies_of("surface = \"red.ply\"\n").front().files.size(), 2u);
  EXPECT_EQ(bodies_of("surface = \"red.ply\"\ncolors = \"body\"\n").front().files.size(), 1u);
  EXPECT_EQ(bodies_of("surface = \"plain.obj\"\n").front().files.size(), 1u);
}

TEST_F(ColoredBody, OtherWordsAndOtherBodiesAreRefused) {
  const auto problem = [](const std::string& keys) {
    const std::vector<std::string> found = test::problems_of("[[body]]\nmaterial = \"jelly\"\n" + keys);
    return found.empty() ? "nothing" : found.front();
  };
  EXPECT_NE(
      problem("box = { extent = [1, 1, 1] }\ncolors = \"file\"\n").find("colors: of a 'surface'; there is none here"),
      std::string::npos);
  EXPECT_NE(problem("box = { extent = [1, 1, 1] }\ncolors = \"red\"\n").find("usual, file or body"), std::string::npos);
  EXPECT_NE(problem("box = { extent = [1, 1, 1] }\ncolors = 3\n").find("colors"), std::string::npos);
}

}  // namespace colored_body_test
}  // namespace supple
