// Tests what is said of skins that their elements do not fill.
#include "scene/building/skin_report.h"

#include <gtest/gtest.h>

#include <fstream>

#include "film/pictures/film_stage.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"

namespace supple {
namespace skin_report_test {

std::vector<Body> bodies_of(const std::filesystem::path& folder, const std::string& keys) {
  std::ofstream(folder / "s.toml") << "[[body]]\nname = \"it\"\nsize = 0.4\nmaterial = \"jelly\"\n" << keys;
  return assemble(load_scene(folder / "s.toml", test::assets, {}));
}

TEST(SkinReport, SaysHowMuchLiesOutsideAndWarnsOfWhatTheElementsMiss) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "spike.toml") << "[[part]]\nsphere = { radius = 0.5 }\n[[part]]\n"
                                               "capsule = { ends = [[0, 0, 0], [0, 1.0, 0]], radius = 0.04 }\n";
  const std::vector<Body> spike = bodies_of(folder.path, "shape = \"spike.toml\"\nvertices = 300");
  const DrawnBody drawn = drawn_bodies(spike).front();
  EXPECT_NE(skin_text(spike[0], drawn).find("% outside the elements, by up to 0.2"), std::string::npos)
      << skin_text(spike[0], drawn);
  const std::optional<Warning> warning = skin_warning(spike[0], drawn);
  ASSERT_TRUE(warning);
  EXPECT_FALSE(warning->meant);
  EXPECT_EQ(skin_words(spike[0], drawn), "in places far from its elements");
  std::vector<Body> meant = spike;
  meant[0].def.meant = {WarningKind::skin};
  EXPECT_TRUE(skin_warning(meant[0], drawn)->meant);
  EXPECT_NE(warning->problem.text().find("the skin of body 'it' reaches 0.2"), std::string::npos)
      << warning->problem.text();
  EXPECT_NE(warning->problem.text().find("more vertices (now 300) fill it"), std::string::npos)
      << warning->problem.text();

  const std::vector<Body> ball = bodies_of(folder.path, "shape = \"shapes/sphere.toml\"\nvertices = 1000");
  const DrawnBody round = drawn_bodies(ball).front();
  EXPECT_FALSE(skin_warning(ball[0], round));
  EXPECT_NE(skin_text(ball[0], round).find("vertices"), std::string::npos);
  EXPECT_EQ(skin_words(ball[0], round), "close to its elements");

  const std::vector<Body> box = bodies_of(folder.path, "box = { extent = [1, 1, 1], cells = [3, 3, 3] }");
  EXPECT_EQ(skin_text(box[0], drawn_bodies(box).front()), "");
}

TEST(SkinReport, MeasuresHowMuchMoreASkinStretchesThanItsElements) {
  const test::TemporaryFolder folder;
  const std::vector<Body> ball = bodies_of(folder.path, "shape = \"shapes/sphere.toml\"\nvertices = 300");
  const DrawnBody drawn = drawn_bodies(ball).front();
  const TetMesh& mesh = ball[0].description.mesh;
  std::vector<float> skin = skin_positions(drawn, mesh, mesh.rest);
  EXPECT_FALSE(skin_excess(drawn, skin, mesh, mesh.rest));
  const float lowest = skin[1];
  skin[1] -= 0.4f;  // one vertex is torn out
  EXPECT_GT(skin_excess(drawn, skin, mesh, mesh.rest).value_or(0), 10);
  skin[1] = lowest;
  const Positions twice = 2 * mesh.rest;
  EXPECT_NEAR(skin_excess(drawn, skin_positions(drawn, mesh, twice), mesh, twice).value_or(0), 1, 0.3);

  // With a limit, the edges that it lists tell first whether there is anything to measure.
  std::vector<DrawnBody> limited = {drawn};
  limit_stretch(limited);
  ASSERT_TRUE(limited[0].limit);
  EXPECT_FALSE(skin_excess(limited[0], skin, mesh, mesh.rest));
  skin[1] -= 0.4f;
  EXPECT_EQ(skin_excess(limited[0], skin, mesh, mesh.rest), skin_excess(drawn, skin, mesh, mesh.rest));
}

// Shards are made by moving points that lie outside away from what they follow.
TEST(DrawnSkin, IsStretchedHardlyMoreThanItsElements) {
  const test::TemporaryFolder folder;
  const std::vector<Body> ball = bodies_of(folder.path, "shape = \"shapes/sphere.toml\"\nvertices = 300");
  const TetMesh& mesh = ball[0].description.mesh;
  std::vector<DrawnBody> drawn = {drawn_bodies(ball).front()};
  const std::vector<float> whole = skin_positions(drawn[0], mesh, mesh.rest);
  limit_stretch(drawn);
  EXPECT_EQ(skin_positions(drawn[0], mesh, mesh.rest), whole) << "nothing is too long";

  std::vector<DrawnBody> torn = {drawn_bodies(ball).front()};
  for (Eigen::Index v = 0; v < torn[0].embedding.points(); ++v)
    if (v % 97 == 0 && torn[0].embedding.outside(v)) torn[0].embedding.offset.row(v) *= 8;
  const std::vector<DrawnBody> as_torn = torn;
  const auto excess = [&mesh](const DrawnBody& body) {
    return skin_excess(body, skin_positions(body, mesh, mesh.rest), mesh, mesh.rest).value_or(1);
  };
  EXPECT_GT(excess(torn[0]), 3);
  limit_stretch(torn);
  EXPECT_LT(excess(torn[0]), 1.5);
  std::vector<DrawnBody> fitted = as_torn;
  fit_to_cameras(fitted, ball, {Camera{}}, 720);
  ASSERT_TRUE(fitted[0].limit);
  EXPECT_LT(excess(fitted[0]), 1.5);
}

}  // namespace skin_report_test
}  // namespace supple
