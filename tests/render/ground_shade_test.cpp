// Tests the colours of the ground against what the formulas say for each pixel by itself.
#include "render/ground_shade.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace supple {
namespace ground_shade_test {

constexpr int width = 811, height = 467;  // neither is a multiple of a tile's edge
const Vec3 stage(0.1, -0.2, 1.5);

StageLight light_at(const Camera& camera) {
  const LightRig rig = sunset_light();
  return {
      rig, rig.to_key.normalized(), camera, {0.7, 0.8, 0.9}, {0.5, 0.4, 0.3}, 1.3, rays_through(camera, width, height)};
}

const Camera above = {Vec3(0.4, 0.8, 4), Vec3(0, 0.6, 0), 35};  // sees the ground, and the sky over it

Tiles all_tiles() {
  Tiles tiles(width, height);
  for (int row = 0; row < tiles.rows(); ++row) {
    for (int column = 0; column < tiles.columns(); ++column) tiles.mark(column, row);
  }
  return tiles;
}

// Returns where the ray through a place of the picture meets the ground; far away where it does not.
Vec3 ground_at(const StageLight& light, double x, double y) {
  const Vec3 ray = light.rays.corner + x * light.rays.right + y * light.rays.up;
  const double way = -light.camera.eye.y() / ray.y();
  return light.camera.eye + (way > 0 ? std::min(way, 1e9) : 1e9) * ray;
}

// Returns the colour of the screen, from 0 to 1, where these shares of the key light and of the sky arrive.
Vec3 color_at(const StageLight& light, const Vec3& place, double lit, double open) {
  const double away = std::hypot(place.x() - stage.x(), place.z() - stage.y()) / stage.z();
  const double t = std::clamp((away - 0.9) / (3.2 - 0.9), 0.0, 1.0), fade = t * t * (3 - 2 * t);
  const double key = light.rig.key_share * (0.12 + 0.88 * lit) * (0.55 + 0.45 * open);
  const Vec3 sky = light.rig.sky_share * open * Vec3(0.97, 1, 1.04);
  const Vec3 there = 1.06 * light.ground.cwiseProduct(Vec3::Constant(key) + sky);
  return film_of(2 * ((1 - fade) * there + fade * light.background), light.exposure);
}

double byte_of(std::uint32_t pixel, int k) { return pixel >> 8 * k & 0xff; }

// Dithering moves a colour by less than half a level, rounding by half of one, and the mean over a pixel and a half of
// what fades slowly by a little. Of what changes in a few pixels, the mean is off by more.
constexpr double levels_off = 1.5, levels_off_near_bodies = 3.5;

TEST(FilmTable, HasTheColorsOfTheFilm) {
  const FilmTable table;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> root(0, 4);
  for (int i = 0; i < 10000; ++i) {
    const double r = root(random), light = r * r;
    const Eigen::Array<float, 4, 1> shown =
        table(Eigen::Array<float, 4, 1>::Constant(static_cast<float>(light)).eval());
    ASSERT_NEAR(shown[2], film_of(light, 1), 1e-5) << light;
  }
}

TEST(GroundShade, TheBareGroundIsThatOfItsFormula) {
  const Camera below = {Vec3(0.4, -0.3, 2), Vec3(0, 0.3, 0), 50}, to_sky = {Vec3(0, 1, 2), Vec3(0, 3, 0), 30};
  for (const Camera& camera : {above, below, to_sky}) {
    const StageLight light = light_at(camera);
    GroundShade shade(width, height, GroundShown::all);
    shade.set_stage(light, stage);
    std::vector<std::uint32_t> picture(std::size_t(width) * height);
    shade.shade_bare(all_tiles(), picture);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Vec3 expected = 255 * color_at(light, ground_at(light, x + 0.5, y + 0.5), 1, 1);
        const std::uint32_t pixel = picture[std::size_t(y) * width + x];
        for (int k = 0; k < 3; ++k)
          ASSERT_NEAR(byte_of(pixel, k), expected[k], levels_off)
              << x << ", " << y << " seen from " << camera.eye.transpose();
        ASSERT_EQ(byte_of(pixel, 3), 255);
      }
    }
  }
}

// Returns the mesh of a plate over the ground.
DrawMesh plate(std::vector<float>& places) {
  DrawMesh mesh;
  mesh.two_sided = true;
  for (const double z : {-0.2, 0.5}) {
    for (const double x : {-0.3, 0.4}) places.insert(places.end(), {float(x), 0.2f, float(z)});
  }
  mesh.triangles = {0, 1, 2, 1, 3, 2};
  return mesh;
}

// Returns the cubic B-spline over the cells at a place, in cells from the middle of the first one.
double spline(const std::vector<float>& open, double u, double v) {
  const auto weights = [](double s) {
    const double r = 1 - s;
    return std::array<double, 4>{r * r * r / 6, (4 - 6 * s * s + 3 * s * s * s) / 6,
                                 (4 - 6 * r * r + 3 * r * r * r) / 6, s * s * s / 6};
  };
  const int i = int(std::floor(u)), j = int(std::floor(v));
  const auto across = weights(u - i), along = weights(v - j);
  double sum = 0;
  for (int b = 0; b < 4; ++b) {
    for (int a = 0; a < 4; ++a) {
      const auto cell = [](int at) { return std::size_t(std::clamp(at, 0, GroundOcclusion::cells - 1)); };
      sum += across[std::size_t(a)] * along[std::size_t(b)] *
             open[cell(j - 1 + b) * GroundOcclusion::cells + cell(i - 1 + a)];
    }
  }
  return sum;
}

// Holds a ground with a plate above it and a shadow that is softly striped.
struct Shaded {
  StageLight light = light_at(above);
  GroundOcclusion occlusion{0.8};
  std::vector<float> open;  // by cell
  GroundLight lit;

  explicit Shaded(const GroundShade& shade) {
    std::vector<std::vector<float>> positions(1);
    const std::vector<DrawMesh> meshes = {plate(positions[0])};
    open = occlusion.compute(meshes, positions, Vec3(0, 0, 0.1), 2.4);
    occlusion.smooth();
    for (int y = 0; y < shade.light_height(); ++y) {
      for (int x = 0; x < shade.light_width(); ++x)
        lit.push_back(static_cast<std::uint16_t>(65535 * lit_at(2 * x + 1.0, 2 * y + 1.0) + 0.5));
    }
  }
  static double lit_at(double x, double y) { return 0.5 + 0.5 * std::sin(0.05 * x + 0.03 * y); }
  double open_at(const Vec3& place) const {
    const double cell = occlusion.extent() / GroundOcclusion::cells;
    const double u = (place.x() - occlusion.origin_x()) / cell, v = (place.z() - occlusion.origin_z()) / cell;
    const bool inside = std::min(u, v) > 0 && std::max(u, v) < GroundOcclusion::cells;
    return inside ? std::min(1.0, spline(open, u - 0.5, v - 0.5) + GroundOcclusion::unseen) : 1;
  }
};

TEST(GroundShade, ShadowsAndContactShadeAreThoseOfTheirFormulas) {
  GroundShade shade(width, height, GroundShown::all);
  const Shaded scene(shade);
  shade.set_stage(scene.light, stage);
  std::vector<std::uint32_t> picture(std::size_t(width) * height);
  shade.shade(all_tiles(), scene.lit, scene.occlusion, picture);
  double least = 1;
  std::vector<double> near_bodies;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec3 place = ground_at(scene.light, x + 0.5, y + 0.5);
      const double open = scene.open_at(place);
      least = std::min(least, open);
      const Vec3 expected = 255 * color_at(scene.light, place, scene.lit_at(x + 0.5, y + 0.5), open);
      const double off = open < 1 ? levels_off_near_bodies : levels_off;
      for (int k = 0; k < 3; ++k) {
        const double difference = byte_of(picture[std::size_t(y) * width + x], k) - expected[k];
        ASSERT_NEAR(difference, 0, off) << x << ", " << y;
        if (open < 1) near_bodies.push_back(std::abs(difference));
      }
    }
  }
  EXPECT_LT(Eigen::Map<Eigen::VectorXd>(near_bodies.data(), Eigen::Index(near_bodies.size())).mean(), 0.5);
  EXPECT_LT(least, 0.3);  // or there is no contact shade to compare
}

TEST(GroundShade, ShadowsAloneCoverAsMuchAsTheyTake) {
  GroundShade shade(width, height, GroundShown::shadows);
  const Shaded scene(shade);
  shade.set_stage(scene.light, stage);
  std::vector<std::uint32_t> picture(std::size_t(width) * height);
  shade.shade(all_tiles(), scene.lit, scene.occlusion, picture);
  const Vec3 luma(0.2126, 0.7152, 0.0722);
  double most = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec3 place = ground_at(scene.light, x + 0.5, y + 0.5);
      const double open = scene.open_at(place), lit = scene.lit_at(x + 0.5, y + 0.5);
      const double left =
          luma.dot(color_at(scene.light, place, lit, open)) / luma.dot(color_at(scene.light, place, 1, 1));
      const std::uint32_t pixel = picture[std::size_t(y) * width + x];
      ASSERT_EQ(pixel & 0xffffff, 0u);
      ASSERT_NEAR(byte_of(pixel, 3), 255 * (1 - left), open < 1 ? levels_off_near_bodies : levels_off)
          << x << ", " << y;
      most = std::max(most, byte_of(pixel, 3));
    }
  }
  EXPECT_GT(most, 60);
}

// Frame after frame, tiles come and go; what a tile shows does not depend on those before it.
TEST(GroundShade, TilesDoNotDependOnTheFrameBefore) {
  GroundShade shade(width, height, GroundShown::all);
  const Shaded scene(shade);
  shade.set_stage(scene.light, stage);
  std::vector<std::uint32_t> all(std::size_t(width) * height), part(all.size());
  shade.shade(all_tiles(), scene.lit, scene.occlusion, all);
  GroundShade other(width, height, GroundShown::all);
  other.set_stage(scene.light, stage);
  const GroundLight dark(scene.lit.size(), 0);
  other.shade(all_tiles(), dark, scene.occlusion, part);
  Tiles some(width, height);
  for (int row = 0; row < some.rows(); ++row) {
    for (int column = row % 3; column < some.columns(); column += 3) some.mark(column, row);
  }
  other.shade(some, scene.lit, scene.occlusion, part);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * width + x;
      if (!some.marked(x / Tiles::edge, y / Tiles::edge)) continue;
      ASSERT_EQ(part[at], all[at]) << x << ", " << y;
    }
  }
}

TEST(GroundShade, PicturesMayBeSmallerThanATile) {
  for (const auto& [wide, high] : {std::pair{1, 1}, {5, 3}, {17, 2}}) {
    GroundShade shade(wide, high, GroundShown::all);
    StageLight light = light_at(above);
    light.rays = rays_through(above, wide, high);
    shade.set_stage(light, stage);
    Tiles tiles(wide, high);
    for (int column = 0; column < tiles.columns(); ++column) tiles.mark(column, 0);
    std::vector<std::uint32_t> picture(std::size_t(wide) * high);
    shade.shade_bare(tiles, picture);
    for (const std::uint32_t pixel : picture) EXPECT_EQ(byte_of(pixel, 3), 255);
  }
}

TEST(GroundShade, OtherTilesStayAsTheyWere) {
  GroundShade shade(width, height, GroundShown::all);
  shade.set_stage(light_at(above), stage);
  Tiles some(width, height);
  some.mark(3, 2);
  some.mark(some.columns() - 1, some.rows() - 1);
  std::vector<std::uint32_t> all(std::size_t(width) * height), part(all.size(), 7);
  shade.shade_bare(all_tiles(), all);
  shade.shade_bare(some, part);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * width + x;
      ASSERT_EQ(part[at], some.marked(x / Tiles::edge, y / Tiles::edge) ? all[at] : 7u) << x << ", " << y;
    }
  }
}

}  // namespace ground_shade_test
}  // namespace supple
