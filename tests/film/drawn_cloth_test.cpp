// Tests how cloth is drawn: its keys, how fine its surface is, and that it stays above the ground.
#include "film/pictures/drawn_cloth.h"

#include <gtest/gtest.h>

#include "support/scene_text.h"

namespace supple {
namespace drawn_cloth_test {

const std::string cloth = "[[body]]\nname = \"sheet\"\ncloth = { extent = [1, 1], cells = [10, 10], stretch = 100 }\n";

std::vector<Body> bodies_of(const std::string& keys) { return assemble(test::scene_of(cloth + keys)); }

ClothLook look_of(const std::string& keys) {
  const Body body = bodies_of(keys).front();
  return cloth_look(body.def, body.description.mesh.rest).value();
}

TEST(DrawnCloth, HasTheBackAndTheYarnsOfItsKeys) {
  const ClothLook given = look_of("back_color = \"#336699\"\nyarn = 0.01\n");
  EXPECT_NEAR((*given.back - Vec3(0.2, 0.4, 0.6)).norm(), 0, 1e-12);
  EXPECT_EQ(given.yarn, 0.01);
  const ClothLook usual = look_of("");
  EXPECT_FALSE(usual.back);
  EXPECT_NEAR(usual.yarn, std::sqrt(2.0) / 700, 1e-12);
  EXPECT_GT(usual.hem, 3 * usual.yarn);
  EXPECT_EQ(look_of("yarn = 0\n").yarn, 0);
}

TEST(DrawnCloth, IsMattUnlessItsGlossIsGiven) {
  EXPECT_LT(gloss_of(bodies_of("").front().def), 0.1);
  EXPECT_EQ(gloss_of(bodies_of("gloss = 0.6\n").front().def), 0.6);
  const SceneDef box = test::scene_of("[[body]]\nbox = { extent = [1, 1, 1] }\nmaterial = \"jelly\"\n");
  EXPECT_EQ(gloss_of(box.bodies[0]), 0.25);
  EXPECT_FALSE(cloth_look(box.bodies[0], Positions::Zero(1, 3)));
}

TEST(DrawnCloth, OtherBodiesHaveNeitherBackNorYarns) {
  const std::vector<std::string> problems = test::problems_of(
      "[[body]]\nbox = { extent = [1, 1, 1] }\nmaterial = \"jelly\"\nback_color = [1, 0, 0]\nyarn = 0.1\n");
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_NE(problems[0].find("back_color: of cloth; this body is none"), std::string::npos);
  EXPECT_NE(problems[1].find("yarn: of cloth; this body is none"), std::string::npos);
}

TEST(DrawnCloth, IsAsFineAsItsPicturesShow) {
  const std::vector<Body> bodies = bodies_of("");
  const auto triangles_at = [&](double pixel, DrawnAs surface) {
    DrawnBody drawn = drawn_bodies(bodies, {}, surface).front();
    if (drawn.subdivides) smooth_for_pixels(drawn, bodies[0].description.mesh.rest, pixel);
    return drawn.skin.rest.triangles.rows();
  };
  EXPECT_EQ(triangles_at(0.05, DrawnAs::skin), 200);
  EXPECT_EQ(triangles_at(0.008, DrawnAs::skin), 800);
  EXPECT_EQ(triangles_at(0.004, DrawnAs::skin), 3200);
  EXPECT_EQ(triangles_at(1e-5, DrawnAs::skin), 12800) << "three times at most";
  EXPECT_EQ(triangles_at(1e-5, DrawnAs::elements), 200);
}

TEST(DrawnCloth, StaysAboveTheGroundWhereItsVerticesDo) {
  const std::vector<Body> bodies = bodies_of("");
  DrawnBody drawn = drawn_bodies(bodies).front();
  const TetMesh& mesh = bodies[0].description.mesh;
  smooth_for_pixels(drawn, mesh.rest, 0.001);
  Positions bent = mesh.rest;
  for (Eigen::Index v = 0; v < bent.rows(); ++v)
    bent.row(v) << mesh.rest(v, 0), std::max(0.0, mesh.rest(v, 1) - 0.5), mesh.rest(v, 1);  // lies, then stands up
  double lowest = 1, lowest_free = 1;
  for (Eigen::Index v = 0; v < drawn.weights.rows(); ++v) {
    lowest = std::min(lowest, smooth_place(drawn.weights, v, bent).y());
    lowest_free = std::min(lowest_free, weighted_point(drawn.weights, v, bent).y());
  }
  EXPECT_LT(lowest_free, -1e-4) << "it would go below";
  EXPECT_EQ(lowest, 0);
  bent.col(1).array() -= 1;  // what lies below the ground stays there
  EXPECT_LT(smooth_place(drawn.weights, 0, bent).y(), -0.9);
}

TEST(DrawnCloth, FoldsAreHollowOnOneSideAndRidgesOnTheOther) {
  const std::vector<Body> bodies = bodies_of("");
  const Body& body = bodies.front();
  const DrawnBody drawn = drawn_bodies(bodies).front();
  Positions valley = body.description.mesh.rest;
  valley.col(2) = valley.col(0).array() * (valley.col(0).array()) * 4;
  Positions ridge = valley;
  ridge.col(2) *= -1;
  const std::vector<float> in_valley = cloth_hollows(drawn, body, valley), on_ridge = cloth_hollows(drawn, body, ridge);
  ASSERT_EQ(in_valley.size(), drawn.skin.occlusion.size());
  for (std::size_t v = 0; v < in_valley.size(); ++v) EXPECT_NEAR(in_valley[v], -on_ridge[v], 1e-5);
  EXPECT_GT(in_valley[60], 0.05);
}

}  // namespace drawn_cloth_test
}  // namespace supple
