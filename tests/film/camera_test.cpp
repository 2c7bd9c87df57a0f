// Where the camera of a film stands: framing, motion, what it follows.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "film/pictures/camera.h"
#include "render/view.h"
#include "support/scene_text.h"

namespace supple {
namespace camera_test {

const std::string cube = R"(
[[body]]
name = "cube"
box = { extent = [1, 1, 1], cells = [2, 2, 2] }
material = "rubber"
)";

// The stage of a scene with one cube that fills [-0.5, 0.5] x [2, 3] x [-0.5, 0.5].
Stage stage_with_cube() {
  Stage stage;
  DrawMesh mesh;
  mesh.rest.include(Vec3(-0.5, 2, -0.5));
  mesh.rest.include(Vec3(0.5, 3, 0.5));
  stage.meshes.push_back(mesh);
  return stage;
}

double farthest_in_picture(const Camera& camera, const Bounds& box, double aspect) {
  const Eigen::Matrix4d view = view_matrix(camera, aspect, box.center(), box.diagonal()).cast<double>();
  double farthest = 0;
  for (int c = 0; c < 8; ++c) {
    const Eigen::Vector4d corner(c & 1 ? box.upper.x() : box.lower.x(), c & 2 ? box.upper.y() : box.lower.y(),
                                 c & 4 ? box.upper.z() : box.lower.z(), 1);
    const Eigen::Vector4d p = view * corner;
    farthest = std::max({farthest, std::abs(p.x() / p.w()), std::abs(p.y() / p.w())});
  }
  return farthest;
}

TEST(Camera, FramesAnyBoxFromAnyDirectionAndNoWiderThanItMust) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.1, 5), angle(-1.5, 1.5);
  for (int sample = 0; sample < 200; ++sample) {
    Bounds box;
    const Vec3 corner(uniform(random), uniform(random), uniform(random));
    box.include(corner);
    box.include(corner + Vec3(uniform(random), uniform(random), uniform(random)));
    const double azimuth = 2 * angle(random), elevation = 0.9 * angle(random), aspect = uniform(random);
    const Vec3 direction(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                         std::cos(azimuth) * std::cos(elevation));
    const Camera camera = framing(box, direction, 35, 1, aspect);
    EXPECT_NEAR(farthest_in_picture(camera, box, aspect), 1, 1e-5);
    EXPECT_LE(farthest_in_picture(framing(box, direction, 35, 1.3, aspect), box, aspect), 1 / 1.2);
    EXPECT_LT((camera.eye - camera.target).normalized().cross(direction).norm(), 1e-12);
  }
}

TEST(Camera, HasTheGroundInViewBelowABodyThatWillFall) {
  const SceneDef falls = test::scene_of(cube);
  const SceneDef floats = test::scene_of("gravity = [0, 0, 0]\n" + cube);
  EXPECT_EQ(framed_box(falls, stage_with_cube()).lower.y(), 0);
  EXPECT_EQ(framed_box(floats, stage_with_cube()).lower.y(), 2);
}

TEST(Camera, GoesRoundItsTarget) {
  const SceneDef scene = test::scene_of(cube + "[camera]\nazimuth = 0\nelevation = 0\norbit = 45\ndistance = 4\n");
  const Stage stage = stage_with_cube();
  const Camera start = camera_at(scene, stage, 0), later = camera_at(scene, stage, 2);
  EXPECT_LT((start.eye - start.target - Vec3(0, 0, 4)).norm(), 1e-12);
  EXPECT_LT((later.eye - later.target - Vec3(4, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(later.target, start.target);
}

TEST(Camera, MovesFromKeyToKeyAndEachValueByItself) {
  const SceneDef scene = test::scene_of(cube + R"([camera]
ease = "linear"
distance = 4
elevation = 0
azimuth = 0
keys = [{ t = 1, azimuth = 0, fov_deg = 20 }, { t = 2, distance = 8 }, { t = 3, azimuth = 90, fov_deg = 40 }]
)");
  const Stage stage = stage_with_cube();
  EXPECT_EQ(camera_at(scene, stage, 0).fov_deg, 20);
  EXPECT_EQ(camera_at(scene, stage, 2).fov_deg, 30);
  EXPECT_EQ(camera_at(scene, stage, 9).fov_deg, 40);
  const Camera middle = camera_at(scene, stage, 2);
  const double half = std::numbers::sqrt2 / 2;
  EXPECT_LT((middle.eye - middle.target - 8 * Vec3(half, 0, half)).norm(), 1e-12);
  EXPECT_NEAR((camera_at(scene, stage, 0).eye - camera_at(scene, stage, 0).target).norm(), 8, 1e-12);
}

TEST(Camera, MovesAlongWithWhatItFollows) {
  const SceneDef scene = test::scene_of(cube + "[camera]\nfollow = \"cube\"\n");
  const Stage stage = stage_with_cube();
  const Vec3 moved(3, -1, 2);
  std::vector<float> points;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {2.0, 3.0}) {
      for (const double z : {-0.5, 0.5}) points.insert(points.end(), {float(x + 3), float(y - 1), float(z + 2)});
    }
  }
  const Camera still = camera_at(scene, stage, 0), along = camera_at(scene, stage, 1, {points});
  EXPECT_LT((along.target - still.target - moved).norm(), 1e-6);
  EXPECT_LT((along.eye - still.eye - moved).norm(), 1e-6);
}

TEST(Camera, RefusesValuesThatSayTheSameTwice) {
  const auto problem = [](const std::string& camera) {
    const std::vector<std::string> problems = test::problems_of(cube + "[camera]\n" + camera);
    return problems.size() == 1 ? problems.front() : std::to_string(problems.size()) + " problems";
  };
  EXPECT_NE(problem("position = [0, 1, 3]\norbit = 3").find("give one or the others"), std::string::npos);
  EXPECT_NE(problem("position = [0, 1, 3]\nkeys = [{ t = 1, azimuth = 3 }]").find("give one or the others"),
            std::string::npos);
  EXPECT_NE(problem("follow = \"cube\"\ntarget = [0, 0, 0]").find("leave target out"), std::string::npos);
  EXPECT_NE(problem("follow = \"cub\"").find("no body or collider is called 'cub'"), std::string::npos);
  EXPECT_NE(problem("keys = [{ t = 1 }, { t = 1 }]").find("order of time"), std::string::npos);
}

TEST(Camera, TellsHowMuchOfABodyIsInThePicture) {
  Stage stage;
  stage.width = 200;
  stage.height = 100;
  Camera camera;  // at a distance of 3, with 30 degrees from top to bottom
  const float high = static_cast<float>(3 * std::tan(15 * std::numbers::pi / 180));
  EXPECT_EQ(share_in_picture(camera, stage, {0, 0, 0, 0, 0.9f * high, 0, 1.9f * high, 0, 0}), 1);
  EXPECT_EQ(share_in_picture(camera, stage, {0, 1.1f * high, 0, 2.1f * high, 0, 0}), 0);
  EXPECT_EQ(share_in_picture(camera, stage, {0, 0, 4}), 0) << "it lies behind the eye";
  EXPECT_NEAR(share_in_picture(camera, stage, {0, 0, 0, 0, 5, 0, 5, 0, 0, 0, 0, -1}), 0.5, 1e-12);
}

}  // namespace camera_test
}  // namespace supple
