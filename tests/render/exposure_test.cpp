// Tests pictures of an open shutter and of a lens against what geometry says of them: ramps, discs and means.
#include "render/exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "render/color.h"
#include "render/renderer.h"
#include "support/places.h"

namespace supple {
namespace exposure_test {

constexpr int width = 160, height = 90;
constexpr double distance = 4, fov_deg = 30;
// The edge of a pixel at the distance of the target [m].
const double pixel = 2 * distance * std::tan(fov_deg * std::numbers::pi / 360) / height;

// Holds a stage with one board that faces the camera, which stands `distance` before the origin.
struct Shot {
  Stage stage;
  DrawList list;

  Shot(Backdrop backdrop, const Vec3& middle, double half_width, double half_height) {
    DrawMesh mesh;
    std::vector<float> places;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      const Vec3 point = middle + Vec3(x * half_width, y * half_height, 0);
      mesh.rest.include(point);
      for (int k = 0; k < 3; ++k) places.push_back(static_cast<float>(point[k]));
    }
    mesh.name = "board";
    mesh.triangles = {0, 1, 2, 0, 2, 3};
    mesh.occlusion.assign(4, 1);
    mesh.two_sided = true;
    mesh.color = Vec3(0.8, 0.3, 0.1);
    mesh.gloss = 0;
    stage.width = width;
    stage.height = height;
    stage.backdrop = backdrop;
    stage.meshes.push_back(std::move(mesh));
    list.camera = {Vec3(0, 1, distance), Vec3(0, 1, 0), fov_deg};
    stage.first_camera = list.camera;
    list.positions.push_back(std::move(places));
  }

  // Opens the shutter over a share of a frame in which the board has come from so many pixels to the left.
  void move(double pixels, double open, int samples) {
    list.exposure.emplace();
    list.exposure->before = list.positions;
    for (std::size_t i = 0; i < list.positions[0].size(); i += 3)
      list.exposure->before[0][i] -= static_cast<float>(pixels * pixel);
    list.exposure->camera_before = list.camera;
    list.exposure->open = open;
    list.exposure->samples = samples;
  }
  void open_lens(double aperture, double focus, int samples) {
    list.exposure.emplace();
    list.exposure->aperture = aperture;
    list.exposure->focus = focus;
    list.exposure->samples = samples;
  }

  Image draw() const { return Renderer(stage, GlChoice::osmesa, test::source_folder / "shaders").draw(list); }
};

// Returns the mean of a picture in linear light, where nothing is covered counts as black.
double mean_light(const Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    sum += linear_of(image.rgb[i] / 255.0) * (image.alpha.empty() ? 1 : image.alpha[i / 3] / 255.0);
  return sum / static_cast<double>(image.rgb.size());
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int(a.rgb[i]) - int(b.rgb[i]));
  return sum / static_cast<double>(a.rgb.size());
}

// Returns the width of the two ramps of a row, on which the coverage goes from nothing to all [pixels].
double ramps_of_row(const Image& image, int row) {
  double width_of_both = 0;
  // Of a linear ramp, the mean of 6 a (1 - a) is one.
  for (int x = 0; x < width; ++x) {
    const double a = image.alpha[std::size_t(row) * width + x] / 255.0;
    width_of_both += 6 * a * (1 - a);
  }
  return width_of_both;
}

TEST(Exposure, AMovingEdgeHasARampAsWideAsItsWayWhileTheShutterIsOpen) {
  constexpr double way = 24;
  for (const double open : {1.0, 0.5}) {
    Shot shot(Backdrop::transparent, Vec3(0, 1, 0), 30 * pixel, 20 * pixel);
    shot.move(way, open, 240);
    EXPECT_NEAR(ramps_of_row(shot.draw(), height / 2), 2 * way * open, 1.2) << open;
  }
  const Shot still(Backdrop::transparent, Vec3(0, 1, 0), 30 * pixel, 20 * pixel);
  EXPECT_LT(ramps_of_row(still.draw(), height / 2), 3);
}

TEST(Exposure, TheShutterClosesAtTheFramesOwnTime) {
  Shot shot(Backdrop::transparent, Vec3(0, 1, 0), 30 * pixel, 20 * pixel);
  const Image sharp = shot.draw();
  shot.move(24, 0.5, 48);
  const Image blurred = shot.draw();
  const auto middle = std::size_t(height / 2) * width;
  for (int x = 0; x < width; ++x) {
    if (x < width / 2 - 44 || x > width / 2 + 31) {
      EXPECT_EQ(blurred.alpha[middle + x], 0) << x;
    }
    if (x > width / 2 - 28 && x < width / 2 + 16) {
      EXPECT_EQ(blurred.alpha[middle + x], 255) << x;
    }
  }
  EXPECT_EQ(sharp.alpha[middle + width / 2 - 32], 0);
}

// A point at distance d becomes a disc of A |1/f - 1/d| as the tangent of an angle, for a lens of diameter A that is
// focused at f.
TEST(Exposure, APointOutOfFocusIsTheDiscOfTheThinLens) {
  for (const double focus : {2.5, 8.0}) {
    Shot shot(Backdrop::transparent, Vec3(0, 1, 0), 2 * pixel, 2 * pixel);
    const double aperture = 0.6;
    shot.open_lens(aperture, focus, 1024);
    const Image image = shot.draw();
    const double disc = aperture * std::abs(1 / focus - 1 / distance) * distance / pixel;
    double area = 0, inertia = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double a = image.alpha[std::size_t(y) * width + x];
        area += a;
        inertia += a * (x + 0.5 - width / 2.0) * (x + 0.5 - width / 2.0);
      }
    }
    // The variance along x is a sixteenth of a disc's squared diameter, and a twelfth of the square's squared edge.
    const double found = std::sqrt(16 * (inertia / area - 16.0 / 12));
    EXPECT_GT(disc, 8);
    EXPECT_NEAR(found, disc, 0.03 * disc) << focus;
  }
}

TEST(Exposure, TheDiscHasNoHolesWithTheUsualNumberOfPictures) {
  Shot shot(Backdrop::transparent, Vec3(0, 1, 0), 2 * pixel, 2 * pixel);
  shot.open_lens(0.6, 2.5, 0);
  const Image image = shot.draw();
  const double disc = 0.6 * std::abs(1 / 2.5 - 1 / distance) * distance / pixel;
  ASSERT_GT(disc, 12);
  int least = 255, most = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (std::hypot(x + 0.5 - width / 2.0, y + 0.5 - height / 2.0) > disc / 2 - 3) continue;
      const int a = image.alpha[std::size_t(y) * width + x];
      least = std::min(least, a);
      most = std::max(most, a);
    }
  }
  EXPECT_GT(least, 0.4 * most);
}

TEST(Exposure, WhatIsInFocusStaysSharp) {
  Shot shot(Backdrop::transparent, Vec3(0, 1, 0), 30 * pixel, 20 * pixel);
  shot.open_lens(0.5, distance, 64);
  EXPECT_LT(ramps_of_row(shot.draw(), height / 2), 3);
}

TEST(Exposure, KeepsTheLight) {
  for (const Backdrop backdrop : {Backdrop::plain, Backdrop::transparent}) {
    Shot shot(backdrop, Vec3(0, 1, 0), 20 * pixel, 12 * pixel);
    const double sharp = mean_light(shot.draw());
    shot.move(24, 1, 32);
    EXPECT_NEAR(mean_light(shot.draw()), sharp, 0.01 * sharp) << int(backdrop);
    shot.open_lens(0.3, 3, 64);
    EXPECT_NEAR(mean_light(shot.draw()), sharp, 0.01 * sharp) << int(backdrop);
  }
}

TEST(Exposure, TransparentEdgesHaveTheBodysColour) {
  Shot shot(Backdrop::transparent, Vec3(0, 1, 0), 30 * pixel, 20 * pixel);
  shot.move(24, 1, 48);
  const Image image = shot.draw();
  const auto middle = std::size_t(height / 2) * width;
  const std::uint8_t* body = &image.rgb[3 * (middle + width / 2)];
  int on_ramps = 0;
  for (std::size_t i = middle; i < middle + width; ++i) {
    if (image.alpha[i] == 0 || image.alpha[i] == 255) continue;
    ++on_ramps;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(image.rgb[3 * i + k], body[k], 4) << i - middle;
  }
  EXPECT_GT(on_ramps, 40);
}

TEST(Exposure, TheUsualNumberOfPicturesIsNearSixtyFourTimesAsMany) {
  Shot shot(Backdrop::ground, Vec3(0, 0.7, 0), 20 * pixel, 12 * pixel);
  shot.move(20, 0.5, 0);
  shot.list.exposure->aperture = 0.1;
  shot.list.exposure->focus = 3.5;
  const int usual = pictures_needed(shot.stage, shot.list);
  EXPECT_EQ(usual, 16);
  const Image few = shot.draw();
  shot.list.exposure->samples = 64 * usual;
  EXPECT_LT(mean_difference(few, shot.draw()), 0.5);
  shot.list.exposure->samples = 1;
  EXPECT_GT(mean_difference(few, shot.draw()), 0.5) << "the blur is seen";
}

TEST(Exposure, WiderBlurAsksForMorePictures) {
  Shot shot(Backdrop::plain, Vec3(0, 1, 0), 5 * pixel, 5 * pixel);
  shot.move(99.5, 1, 0);
  EXPECT_EQ(pictures_needed(shot.stage, shot.list), 100);
  shot.move(2, 1, 0);
  EXPECT_EQ(pictures_needed(shot.stage, shot.list), 16);
  shot.open_lens(10, 1, 0);
  EXPECT_EQ(pictures_needed(shot.stage, shot.list), 128);
}

TEST(Exposure, LeavesPicturesOfAnInstantAndPassesAsTheyAre) {
  Shot shot(Backdrop::ground, Vec3(0, 0.8, 0), 20 * pixel, 12 * pixel);
  constexpr PicturePass all[] = {PicturePass::depth, PicturePass::masks};
  Renderer renderer(shot.stage, GlChoice::osmesa, test::source_folder / "shaders");
  const Image before = renderer.draw(shot.list);
  const std::vector<PassImage> sharp = renderer.passes(shot.list, nullptr, all);
  shot.move(24, 1, 8);
  EXPECT_GT(mean_difference(before, renderer.draw(shot.list)), 0.2);
  const std::vector<PassImage> blurred = renderer.passes(shot.list, nullptr, all);
  for (std::size_t i = 0; i < sharp.size(); ++i) EXPECT_EQ(blurred[i].values, sharp[i].values) << i;
  shot.list.exposure.reset();
  EXPECT_EQ(renderer.draw(shot.list).rgb, before.rgb);
}

TEST(Exposure, SamplesFillTimesAndTheDiscEvenly) {
  Exposure exposure;
  exposure.open = 0.5;
  for (const int count : {1, 16, 37, 128}) {
    const std::vector<ExposureSample> samples = exposure_samples(exposure, count);
    std::set<std::pair<double, double>> places;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const ExposureSample& sample : samples) {
      places.emplace(sample.on_lens.x(), sample.on_lens.y());
      sum += sample.on_lens;
      EXPECT_LE(sample.on_lens.norm(), 1);
      EXPECT_GT(sample.time, 0.5);
      EXPECT_LT(sample.time, 1);
    }
    EXPECT_EQ(places.size(), std::size_t(count)) << "each place of the spiral is taken once";
    EXPECT_LT(sum.norm() / count, count == 1 ? 0.8 : 0.05);
  }
}

}  // namespace exposure_test
}  // namespace supple
