// Tests the looks of bodies and colliders in a film: the keys of their finish, what a replay changes of it, and how
// round their skins are.
#include <gtest/gtest.h>

#include <fstream>

#include "film/pictures/drawn_film.h"
#include "support/film.h"
#include "support/scene_text.h"

namespace supple {
namespace drawn_look_test {

const std::string box = "[[body]]\nname = \"it\"\nbox = { extent = [1, 1, 1] }\nmaterial = \"jelly\"\n";
const std::string ball =
    "[[body]]\nname = \"it\"\nshape = \"shapes/sphere.toml\"\nvertices = 300\nsize = 0.4\n"
    "material = \"jelly\"\n";
const std::string block =
    "[[collider]]\nname = \"block\"\nshape = { capsule = { ends = [[-1, 0, 0], [1, 0, 0]], radius = 0.03 } }\nposition "
    "= [2, 0, 0]\n";

TEST(DrawnLook, ASurfaceIsAsRoughAndAsTranslucentAsItsKeys) {
  const SceneDef given = test::scene_of(box + "roughness = 0.2\ntranslucent = 0.7\n" + block + "roughness = 1\n");
  EXPECT_EQ(given.bodies[0].finish, (Finish{0.2, 0.7}));
  EXPECT_EQ(given.colliders[0].finish, (Finish{1.0, 0.0}));
  EXPECT_EQ(test::scene_of(box).bodies[0].finish, Finish{});
}

TEST(DrawnLook, AGlossAndARoughnessContradictEachOther) {
  const std::vector<std::string> problems =
      test::problems_of(box + "gloss = 0.5\nroughness = 0.2\ntranslucent = 1.5\n");
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_NE(problems[0].find("roughness: takes the place of 'gloss', so give one of them"), std::string::npos)
      << problems[0];
  EXPECT_NE(problems[1].find("translucent"), std::string::npos) << problems[1];
}

struct Filmed {
  test::TemporaryFolder folder;
  std::filesystem::path file = folder.path / "s.toml";
  std::vector<std::string> settings;

  Filmed(const std::string& text, std::vector<std::string> given) : settings(std::move(given)) {
    std::ofstream(file) << text;
  }

  // Makes what is drawn of the start of the film. change: changes the scene of the second list that is made.
  template <class Change>
  std::pair<Stage, DrawList> drawn(const Change& change) const {
    const test::Film film(file, settings);
    const Script script = Script::load(file, test::assets, settings);
    DrawnFilm pictures(script, film.bodies, drawn_bodies(film.bodies), film.set, Font{});
    const Positions start = first_positions(film.bodies[0]);
    FramePose pose{-1, 0, {}, {}};
    pose.motion.push_back(&start);
    Threads threads(1);
    SceneDef scene = film.scene;
    pictures.list(scene, pose, film.set, threads);
    change(scene);
    return {pictures.stage(), pictures.list(scene, pose, film.set, threads)};
  }
};

TEST(DrawnLook, AReplayChangesTheFinish) {
  const Filmed film(ball + block, {});
  EXPECT_TRUE(film.drawn([](SceneDef&) {}).second.renewed.empty());
  const DrawList list = film.drawn([](SceneDef& scene) { scene.bodies[0].finish = {0.1, 0.3}; }).second;
  ASSERT_EQ(list.renewed.size(), 1u);
  EXPECT_EQ(list.renewed[0].second.finish, (Finish{0.1, 0.3}));
}

TEST(DrawnLook, SkinsAreRounderInLargePicturesAndTheSameInSmallOnes) {
  const auto triangles = [](int height, const std::string& cells) {
    const Filmed film(ball + "skin_cells = " + cells + "\n" + block,
                      {"output.width=" + std::to_string(2 * height), "output.height=" + std::to_string(height)});
    const auto [stage, list] = film.drawn([](SceneDef&) {});
    EXPECT_EQ(list.positions[0].size(), 3 * stage.meshes[0].occlusion.size());
    EXPECT_EQ(list.positions[1].size(), 3 * stage.meshes[1].occlusion.size());
    return std::pair{stage.meshes[0].triangles.size(), stage.meshes[1].triangles.size()};
  };
  const auto [small_body, small_collider] = triangles(60, "20");
  EXPECT_EQ(triangles(90, "20").second, small_collider);
  const auto [large_body, large_collider] = triangles(4096, "20");
  EXPECT_GT(large_body, 2 * small_body);
  EXPECT_GT(large_collider, 2 * small_collider);
}

// All that is drawn lies on the ball, whichever triangles were cut, and moves with its elements.
TEST(DrawnLook, ARoundedSkinIsCarriedByItsElements) {
  const Filmed film(ball + "skin_cells = 12\n", {"output.width=3840", "output.height=2160"});
  const auto [stage, list] = film.drawn([](SceneDef&) {});
  const Body body = test::Film(film.file, film.settings).bodies[0];
  const Vec3 center = body.placement * Vec3(0, 1, 0);
  double worst = 0;
  for (std::size_t i = 0; i < list.positions[0].size(); i += 3) {
    const Vec3 at(list.positions[0][i], list.positions[0][i + 1], list.positions[0][i + 2]);
    worst = std::max(worst, std::abs((at - center).norm() - scale_of(body)));
  }
  EXPECT_LT(worst, 1e-5);
}

}  // namespace drawn_look_test
}  // namespace supple
