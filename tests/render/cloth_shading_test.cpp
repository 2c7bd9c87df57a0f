// Tests what the shader makes of cloth: its two sides, yarns, hem and folds.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/renderer.h"
#include "support/places.h"

namespace supple {
namespace cloth_shading_test {

constexpr int width = 240, height = 160;

ClothLook with_yarn(double yarn) { return {std::nullopt, yarn, 0}; }
ClothLook with_hem(double hem) { return {std::nullopt, 0, hem}; }

// Describes an upright square of a metre on a plain backdrop, which shows its front to positive z.
struct Sheet {
  ClothLook look = {};
  float hollow = 0;
  double side = 1;  // of the cloth on which the camera stands
  double distance = 4;

  Image draw() const {
    Stage stage;
    stage.width = width;
    stage.height = height;
    stage.backdrop = Backdrop::plain;
    DrawMesh mesh;
    mesh.triangles = {0, 1, 2, 0, 2, 3};
    mesh.occlusion.assign(4, 1);
    mesh.flat = {{0, 0, 0}, {1, 0, 1}, {1, 1, 1}, {0, 1, 0}};  // its left border is open
    mesh.two_sided = true;
    mesh.gloss = 0;
    mesh.color = Vec3(0.8, 0.15, 0.1);
    mesh.cloth = look;
    mesh.rest.include(Vec3(-0.5, 0.5, 0));
    mesh.rest.include(Vec3(0.5, 1.5, 0));
    stage.meshes = {mesh};
    DrawList list;
    list.camera = stage.first_camera = {Vec3(0, 1, side * distance), Vec3(0, 1, 0), 20};
    list.positions = {{-0.5f, 0.5f, 0, 0.5f, 0.5f, 0, 0.5f, 1.5f, 0, -0.5f, 1.5f, 0}};
    list.hollow = {std::vector<float>(4, hollow)};
    Renderer renderer(stage, GlChoice::osmesa, test::source_folder / "shaders");
    return renderer.draw(list);
  }
};

std::array<int, 3> pixel(const Image& image, int x, int y) {
  const std::size_t at = 3 * (std::size_t(y) * width + std::size_t(x));
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

std::array<int, 3> middle(const Image& image) { return pixel(image, width / 2, height / 2); }

int brightness(const std::array<int, 3>& color) { return color[0] + color[1] + color[2]; }

// Returns how much the brightness of neighbours in the middle of a picture differs, root mean square [of 765].
double contrast(const Image& image) {
  double sum = 0;
  int count = 0;
  for (int y = height / 2 - 20; y < height / 2 + 20; ++y) {
    for (int x = width / 2 - 20; x < width / 2 + 20; ++x, ++count) {
      const double change = brightness(pixel(image, x, y)) - brightness(pixel(image, x + 1, y));
      sum += change * change;
    }
  }
  return std::sqrt(sum / count);
}

TEST(ClothShading, EachSideHasItsColour) {
  const Vec3 blue(0.1, 0.2, 0.8);
  const std::array<int, 3> front = middle(Sheet{.look = {.back = blue}}.draw()),
                           back = middle(Sheet{.look = {.back = blue}, .side = -1}.draw());
  EXPECT_GT(front[0], 2 * front[2]);
  EXPECT_GT(back[2], 2 * back[0]);
}

TEST(ClothShading, TheBackIsDarkerAndPalerWithoutAColour) {
  const std::array<int, 3> own = middle(Sheet{.side = -1}.draw()),
                           as_front = middle(Sheet{.look = {.back = Vec3(0.8, 0.15, 0.1)}, .side = -1}.draw());
  EXPECT_LT(own[0], as_front[0] - 10);
  EXPECT_LT(double(own[0]) / own[2], double(as_front[0]) / as_front[2]);
  EXPECT_GT(own[0], own[2] + 20) << "it has the hue of the front";
}

TEST(ClothShading, YarnsAreSeenWherePixelsAreFineAndGoneBeforeTheyMakeMoire) {
  const double pixel_size = 2 * std::tan(10 * 3.14159 / 180) * 4 / height;  // on the cloth [m]
  EXPECT_GT(contrast(Sheet{.look = with_yarn(6 * pixel_size)}.draw()), 10);
  EXPECT_LT(contrast(Sheet{.look = with_yarn(2.6 * pixel_size)}.draw()), 1);
  EXPECT_LT(contrast(Sheet{.look = with_yarn(0.7 * pixel_size)}.draw()), 1);
  // The mean brightness stays.
  const auto mean = [](const Image& image) {
    double sum = 0;
    for (int y = height / 2 - 24; y < height / 2 + 24; ++y)
      for (int x = width / 2 - 24; x < width / 2 + 24; ++x) sum += brightness(pixel(image, x, y));
    return sum / (48 * 48);
  };
  const double fine = mean(Sheet{.look = with_yarn(1e-4)}.draw()),
               coarse = mean(Sheet{.look = with_yarn(6 * pixel_size)}.draw());
  EXPECT_NEAR(coarse / fine, 1, 0.05);
}

TEST(ClothShading, AHemRunsAlongTheOpenBorderAlone) {
  const Image plain = Sheet{}.draw(), hemmed = Sheet{.look = with_hem(0.1)}.draw();
  const auto at = [](double x) { return int(std::lround(width / 2 + x * height / (2 * std::tan(0.17453) * 4))); };
  const auto change = [&](double x) {
    return brightness(pixel(hemmed, at(x), height / 2)) - brightness(pixel(plain, at(x), height / 2));
  };
  EXPECT_LT(change(-0.4), -20) << "the seam";
  EXPECT_EQ(change(0), 0);
  EXPECT_EQ(change(0.45), 0);
}

TEST(ClothShading, ValleysOfFoldsAreDarkerOnTheSideFromWhichTheyAreSeen) {
  for (const double side : {1.0, -1.0}) {
    const int even = brightness(middle(Sheet{.side = side}.draw()));
    EXPECT_LT(brightness(middle(Sheet{.hollow = float(0.8 * side), .side = side}.draw())), even - 20);
    EXPECT_GT(brightness(middle(Sheet{.hollow = float(-0.8 * side), .side = side}.draw())), even);
  }
}

}  // namespace cloth_shading_test
}  // namespace supple
