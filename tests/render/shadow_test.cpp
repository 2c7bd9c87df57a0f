// Tests what shadows look like: smooth where they are soft, and none the less there in narrow folds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/renderer.h"
#include "support/places.h"

namespace supple {
namespace shadow_test {

// Holds meshes that are written by hand, and their positions.
struct Scenery {
  Stage stage;
  DrawList list;

  // Adds a sheet of rows of points, which all have as many.
  void add_sheet(const std::vector<std::vector<Vec3>>& rows) {
    DrawMesh mesh;
    std::vector<float> places;
    const auto across = static_cast<std::uint32_t>(rows.front().size());
    for (std::uint32_t r = 0; r < rows.size(); ++r) {
      for (std::uint32_t c = 0; c < across; ++c) {
        for (int k = 0; k < 3; ++k) places.push_back(static_cast<float>(rows[r][c][k]));
        mesh.rest.include(rows[r][c]);
        if (r == 0 || c == 0) continue;
        const std::uint32_t a = (r - 1) * across + c - 1, b = a + 1, d = a + across, e = d + 1;
        mesh.triangles.insert(mesh.triangles.end(), {a, d, e, a, e, b});
      }
    }
    mesh.occlusion.assign(places.size() / 3, 1.0f);
    mesh.two_sided = true;
    mesh.gloss = 0;
    mesh.color = Vec3(0.7, 0.7, 0.7);
    stage.meshes.push_back(std::move(mesh));
    list.positions.push_back(std::move(places));
  }

  Image draw() {
    stage.first_camera = list.camera;
    Renderer renderer(stage, GlChoice::osmesa, test::source_folder / "shaders");
    return renderer.draw(list);
  }
};

// Returns a level square around a point.
std::vector<std::vector<Vec3>> square_at(const Vec3& middle, double half) {
  std::vector<std::vector<Vec3>> rows(2);
  for (int r = 0; r < 2; ++r) {
    for (const double x : {-half, half}) rows[r].push_back(middle + Vec3(x, 0, r == 0 ? -half : half));
  }
  return rows;
}

double grey(const Image& image, int x, int y) { return image.rgb[3 * (std::size_t(y) * image.width + x) + 1]; }

// Returns by how much pixels differ from the mean of the 3 x 3 around them (root mean square, of 255), over those of an
// area that are neither lit nor in full shadow.
double grain(const Image& image, int left, int top, int right, int bottom) {
  std::vector<double> all;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) all.push_back(grey(image, x, y));
  }
  std::ranges::sort(all);
  const double dark = all[all.size() / 20], bright = all[all.size() - 1 - all.size() / 20];
  EXPECT_GT(bright - dark, 30) << "there is no shadow";
  double sum = 0;
  int pixels = 0;
  for (int y = top + 1; y + 1 < bottom; ++y) {
    for (int x = left + 1; x + 1 < right; ++x) {
      double mean = 0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) mean += grey(image, x + i, y + j) / 9;
      }
      const double share = (mean - dark) / (bright - dark);
      if (share < 0.1 || share > 0.9) continue;
      sum += (grey(image, x, y) - mean) * (grey(image, x, y) - mean);
      ++pixels;
    }
  }
  EXPECT_GT(pixels, 2000) << "the shadow is not soft";
  return std::sqrt(sum / pixels);
}

// Returns a view from above of the right edge of the shadow that a square in the air casts on the ground, or on another
// square above that.
Scenery square_in_the_air(bool over_another) {
  Scenery scenery;
  scenery.stage.width = 960;
  scenery.stage.height = 540;
  scenery.stage.colors.ground = Vec3(0.5, 0.5, 0.5);
  scenery.add_sheet(square_at(Vec3(0, 0.9, 0), 0.9));
  if (over_another) scenery.add_sheet(square_at(Vec3(0, 0.1, 0), 2.5));
  scenery.list.camera = {Vec3(1.35, 3, 0.3), Vec3(1.35, 0, -0.2), 26};
  return scenery;
}

TEST(Shadow, OnASurfaceIsSoftWithoutGrain) {
  const Image image = square_in_the_air(true).draw();
  EXPECT_LT(grain(image, 330, 150, 640, 390), 0.5);
}

TEST(Shadow, OnTheGroundIsSoftWithoutGrain) {
  const Image image = square_in_the_air(false).draw();
  EXPECT_LT(grain(image, 330, 150, 640, 390), 0.48);
}

// Returns a sheet that is rolled up around the x axis but for an opening in front, so that its upper edge keeps the
// light from what is seen inside. A large square lies below it: the wider the borders of shadows may be, the closer the
// walls of the roll are to each other beside them. covered: whether another square keeps all light from the roll.
Scenery roll(bool covered) {
  Scenery scenery;
  scenery.stage.width = 1280;
  scenery.stage.height = 720;
  constexpr double radius = 0.03, from = 20, to = 300;  // [m], and degrees from the front upwards
  std::vector<std::vector<Vec3>> rows(25);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double angle = std::numbers::pi / 180 * (from + (to - from) * double(k) / double(rows.size() - 1));
    for (const double x : {-0.3, 0.3})
      rows[k].push_back(Vec3(x, 0.2 + radius * std::sin(angle), radius * std::cos(angle)));
  }
  scenery.add_sheet(rows);
  scenery.add_sheet(square_at(Vec3(0, 0.001, 0), 1.6));
  if (covered) scenery.add_sheet(square_at(1.2 * scenery.stage.light.to_key, 0.8));
  scenery.list.camera = {Vec3(0, 0.12, 1), Vec3(0, 0.2, 0), 8};
  return scenery;
}

TEST(Shadow, LiesInNarrowFoldsAsWell) {
  const Image open = roll(false).draw(), covered = roll(true).draw();
  int bright = 0, pixels = 0;
  for (int y = 330; y < 430; ++y) {  // between the edges of the roll
    for (int x = 500; x < 780; ++x, ++pixels) bright += grey(open, x, y) - grey(covered, x, y) > 20 ? 1 : 0;
  }
  EXPECT_LT(bright, pixels / 100);
}

}  // namespace shadow_test
}  // namespace supple
