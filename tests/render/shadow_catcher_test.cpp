// Tests pictures that have the ground's shadows alone: laid over the ground, they are the picture with the ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/renderer.h"
#include "support/places.h"

namespace supple {
namespace shadow_catcher_test {

constexpr int width = 320, height = 180;

// Returns a stage with a box that stands on the ground, and its list. The box is a point where `is_there` is false, so
// that the ground is bare.
std::pair<Stage, DrawList> box_on_ground(Backdrop backdrop, bool is_there) {
  DrawMesh mesh;
  std::vector<float> places;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 point((corner & 1) != 0 ? 0.3 : -0.3, (corner & 2) != 0 ? 0.6 : 0, (corner & 4) != 0 ? 0.3 : -0.3);
    mesh.rest.include(point);
    for (int k = 0; k < 3; ++k) places.push_back(is_there ? static_cast<float>(point[k]) : 0.0F);
  }
  mesh.triangles = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 4, 6, 0, 6, 2,
                    1, 3, 7, 1, 7, 5, 2, 6, 7, 2, 7, 3, 0, 1, 5, 0, 5, 4};
  mesh.occlusion.assign(8, 1);
  mesh.color = Vec3(0.8, 0.3, 0.1);
  Stage stage;
  stage.width = width;
  stage.height = height;
  stage.backdrop = backdrop;
  stage.meshes.push_back(std::move(mesh));
  DrawList list;
  list.camera = {Vec3(1.2, 1.3, 2.6), Vec3(0.1, 0.2, 0), 32};
  list.positions.push_back(std::move(places));
  stage.first_camera = list.camera;
  return {stage, list};
}

Image picture(Backdrop backdrop, bool is_there) {
  const auto [stage, list] = box_on_ground(backdrop, is_there);
  Renderer renderer(stage, GlChoice::osmesa, test::source_folder / "shaders");
  return renderer.draw(list);
}

TEST(ShadowCatcher, LaidOverTheBareGroundIsThePictureWithTheGround) {
  const Image whole = picture(Backdrop::ground, true), bare = picture(Backdrop::ground, false),
              caught = picture(Backdrop::shadows, true);
  ASSERT_EQ(caught.alpha.size(), std::size_t(width) * height);
  int largest = 0, shaded = 0;
  double sum = 0;
  for (std::size_t i = 0; i < 3 * caught.alpha.size(); ++i) {
    const double share = caught.alpha[i / 3] / 255.0;
    const double laid = share * caught.rgb[i] + (1 - share) * bare.rgb[i];
    const int off = static_cast<int>(std::lround(std::abs(laid - whole.rgb[i])));
    largest = std::max(largest, off);
    sum += off;
    shaded += std::abs(bare.rgb[i] - whole.rgb[i]) > 20 && caught.rgb[i] == 0;
  }
  EXPECT_GT(shaded, 2000) << "the ground has a shadow";
  // The key light is warm and the sky is cool, so that a shadow is a little bluer than black over the ground.
  EXPECT_LE(largest, 8);
  EXPECT_LT(sum / (3 * double(caught.alpha.size())), 0.6);
}

TEST(ShadowCatcher, IsEmptyWhereNothingCastsAShadow) {
  const Image caught = picture(Backdrop::shadows, false);
  EXPECT_EQ(std::ranges::max(caught.alpha), 0);
  const Image body = picture(Backdrop::transparent, true), both = picture(Backdrop::shadows, true);
  for (std::size_t i = 0; i < body.alpha.size(); ++i) {
    EXPECT_GE(both.alpha[i], body.alpha[i]);
    if (body.alpha[i] == 255) {
      EXPECT_EQ(both.rgb[3 * i], body.rgb[3 * i]);
    }
  }
  EXPECT_EQ(both.alpha[0], 0) << "far from the box";
}

}  // namespace shadow_catcher_test
}  // namespace supple
