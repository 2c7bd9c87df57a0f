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

// Returns the largest distances from the middle in the picture, to the sides and up or down, in half its sides.
Eigen::Vector2d farthest_of(const Camera& camera, const std::vector<Vec3>& points, double aspect) {
  Bounds box;
  for (const Vec3& point : points) box.include(point);
  const Eigen::Matrix4d view = view_matrix(camera, aspect, box.center(), box.diagonal()).cast<double>();
  Eigen::Vector2d farthest(0, 0);
  for (const Vec3& point : points) {
    const Eigen::Vector4d p = view * point.homogeneous();
    farthest = farthest.cwiseMax((p.head<2>() / p.w()).cwiseAbs());
  }
  return farthest;
}

TEST(Camera, FramesPointsAsLargeAsThePictureAllows) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int sample = 0; sample < 200; ++sample) {
    std::vector<Vec3> points;
    for (int i = 0; i < 30; ++i) points.emplace_back(3 * uniform(random), uniform(random), 2 * uniform(random));
    const double azimuth = 3 * uniform(random), elevation = 1.4 * uniform(random), aspect = 1.5 + uniform(random);
    const Vec3 direction(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                         std::cos(azimuth) * std::cos(elevation));
    const Camera camera = framing(points, direction, 35, 1, aspect, 0);
    EXPECT_NEAR(farthest_of(camera, points, aspect).maxCoeff(), 1, 1e-4);
    EXPECT_LT((camera.eye - camera.target).normalized().cross(direction).norm(), 1e-12);
    EXPECT_LT(farthest_of(framing(points, direction, 35, 1.2, aspect, 0.06), points, aspect).maxCoeff(), 1 / 1.19);
  }
}

TEST(Camera, ShowsTheWholeMotionOfAStageThatKnowsItWhereTheSceneAsksForItAndDoesNotPlaceIt) {
  Stage stage = stage_with_cube();
  const Stage still = stage;
  stage.motion = {Vec3(-0.5, 0, -0.5), Vec3(0.5, 3, 0.5), Vec3(4, 0, 0)};
  const std::string automatic = "[camera]\nframes = \"auto\"\n";
  const auto eye = [](const std::string& keys, const Stage& on) {
    return camera_at(test::scene_of(cube + keys), on, 0).eye;
  };
  const SceneDef open = test::scene_of(cube + automatic);
  EXPECT_LE(farthest_of(camera_at(open, stage, 0), stage.motion, 16.0 / 9).maxCoeff(), 1);
  EXPECT_GT(farthest_of(camera_at(open, still, 0), stage.motion, 16.0 / 9).maxCoeff(), 1);
  EXPECT_EQ(eye("[camera]\nframes = \"film\"\n", stage), eye(automatic, stage));
  for (const std::string& keys :
       {std::string(), std::string("[camera]\nframes = \"start\"\n"), automatic + "distance = 4\n",
        automatic + "position = [0, 1, 3]\n", automatic + "keys = [{ t = 1, azimuth = 3 }]\n"})
    EXPECT_EQ(eye(keys, stage), eye(keys, still)) << keys;
}

TEST(Camera, KeepsInANarrowerPictureWhatAWideOneShowsToTheSides) {
  const std::string placed = "[camera]\nposition = [0, 2.5, 6]\ntarget = [0, 2.5, 0]\n";
  Stage stage = stage_with_cube();
  stage.motion = {Vec3(-2, 2, 0), Vec3(2, 3, 0)};
  const auto fov = [&](const std::string& output, int width, int height) {
    stage.width = width;
    stage.height = height;
    return camera_at(test::scene_of(cube + placed + output), stage, 0).fov_deg;
  };
  EXPECT_EQ(fov("", 1280, 720), 30);
  EXPECT_EQ(fov("[output]\nwidth = 1080\nheight = 1920\n", 1080, 1920), 30) << "a shape of the scene's own";
  EXPECT_EQ(fov("[output]\nsize = \"4k\"\n", 3840, 2160), 30) << "the same shape";
  const SceneDef portrait = test::scene_of(cube + placed + "[output]\nsize = \"portrait\"\n");
  EXPECT_EQ(portrait.output.width, 1080);
  EXPECT_EQ(portrait.output.height, 1920);
  EXPECT_GT(fov("[output]\nsize = \"portrait\"\n", 1080, 1920), 60);
  const Eigen::Vector2d farthest = farthest_of(camera_at(portrait, stage, 0), stage.motion, 1080.0 / 1920);
  EXPECT_NEAR(farthest.x(), 1 / 1.05, 1e-4);
}

TEST(Camera, RefusesASizeThatIsNone) {
  for (const char* size : {"12", "640x361", "landscape", "9000x100", "64x48 "}) {
    const std::vector<std::string> problems = test::problems_of(cube + "[output]\nsize = \"" + size + "\"\n");
    ASSERT_EQ(problems.size(), 1u) << size;
    EXPECT_NE(problems[0].find("is none of portrait (1080x1920), square (1080x1080)"), std::string::npos)
        << problems[0];
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
