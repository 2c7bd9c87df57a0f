#include "render/visibility.h"

#include <gtest/gtest.h>

#include <random>

#include "render/view.h"

namespace supple {
namespace visibility_test {

constexpr int width = 97, height = 61;
constexpr int parts = SampleBuffer::parts;
using Corners = std::array<ScreenCorner, 3>;

// Returns a sample's place [parts], found from the places that the buffer tells.
std::array<std::int64_t, 2> place_of(const std::vector<float>& places, int x, int y, int sample) {
  const std::size_t at = 2 * std::size_t(sample);
  return {std::int64_t(x) * parts + std::int64_t(places[at] * parts),
          std::int64_t(y) * parts + std::int64_t(places[at + 1] * parts)};
}

// Returns twice the area of the triangle of two corners and a place; positive when it is anticlockwise.
std::int64_t side(const ScreenCorner& a, const ScreenCorner& b, const std::array<std::int64_t, 2>& p) {
  return (b.x - std::int64_t(a.x)) * (p[1] - a.y) - (b.y - std::int64_t(a.y)) * (p[0] - a.x);
}

Corners random_corners(std::mt19937& random, int reach) {
  std::uniform_int_distribution<int> x(-reach * parts, (width + reach) * parts),
      y(-reach * parts, (height + reach) * parts);
  std::uniform_real_distribution<float> nearness(0.1f, 2);
  Corners corners;
  for (ScreenCorner& corner : corners) corner = {x(random), y(random), nearness(random)};
  return corners;
}

TEST(SampleBuffer, ATriangleCoversTheSamplesInsideAndTheirNearnessIsThatOfItsPlane) {
  std::mt19937 random(1);
  for (const int samples : {1, 2, 4, 8}) {
    // The large triangles lie mostly beyond the picture, and take the path with wide integers.
    for (int round = 0; round < 60; ++round) {
      SampleBuffer buffer(width, height, samples);
      const std::vector<float> places = buffer.places();
      Corners corners = random_corners(random, round % 3 == 0 ? 2000 : 0);
      for (ScreenCorner& corner : corners) {
        if (round % 3 == 1) corner = {corner.x / 8 + 4000, corner.y / 8 + 4000, corner.nearness};
      }
      const std::int64_t area = side(corners[0], corners[1], {corners[2].x, corners[2].y});
      const SampleBuffer::Box box = buffer.fill(corners, 7, Facing::both, Samples::all);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          for (int s = 0; s < samples; ++s) {
            const auto p = place_of(places, x, y, s);
            const double turn = area > 0 ? 1 : -1, a = turn * double(side(corners[1], corners[2], p)),
                         b = turn * double(side(corners[2], corners[0], p)),
                         c = turn * double(side(corners[0], corners[1], p));
            if (a == 0 || b == 0 || c == 0) continue;  // the next test is on edges
            const bool inside = a > 0 && b > 0 && c > 0;
            ASSERT_EQ(buffer.numbers(x, y)[s], inside ? 7u : 0u) << samples << " samples, " << x << ", " << y;
            if (!inside) continue;
            EXPECT_TRUE(x >= box.left && x <= box.right && y >= box.low && y <= box.high);
            const double expected =
                (a * corners[0].nearness + b * corners[1].nearness + c * corners[2].nearness) / std::abs(double(area));
            EXPECT_NEAR(buffer.nearness(x, y)[s], expected, 2e-4);
          }
        }
      }
    }
  }
}

// The corners lie on sixteenths of a pixel, as samples do, so that many samples are on edges and corners.
TEST(SampleBuffer, TrianglesThatShareEdgesCoverEachSampleOnce) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> shift(-24, 24);
  for (const int samples : {1, 4, 8}) {
    for (const int cell : {5, 30}) {  // pixels
      const int columns = width / cell + 3, rows = height / cell + 3;
      std::vector<ScreenCorner> grid;
      for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i)
          grid.push_back({((i - 1) * cell * 16 + shift(random)) * parts / 16,
                          ((j - 1) * cell * 16 + shift(random)) * parts / 16, 1});
      }
      std::vector<int> covered(std::size_t(width) * height * samples, 0);
      const auto add = [&](const Corners& corners) {
        SampleBuffer buffer(width, height, samples);
        buffer.fill(corners, 1, Facing::towards, Samples::all);
        for (int y = 0; y < height; ++y) {
          for (int x = 0; x < width; ++x) {
            for (int s = 0; s < samples; ++s)
              covered[(std::size_t(y) * width + x) * samples + s] += buffer.numbers(x, y)[s] == 0 ? 0 : 1;
          }
        }
      };
      for (int j = 0; j + 1 < rows; ++j) {
        for (int i = 0; i + 1 < columns; ++i) {
          const ScreenCorner a = grid[j * columns + i], b = grid[j * columns + i + 1],
                             c = grid[(j + 1) * columns + i + 1], d = grid[(j + 1) * columns + i];
          (i + j) % 2 == 0 ? (add({a, b, c}), add({a, c, d})) : (add({b, c, d}), add({b, d, a}));
        }
      }
      EXPECT_EQ(std::count(covered.begin(), covered.end(), 1), std::ssize(covered))
          << samples << " samples, cells of " << cell;
    }
  }
}

TEST(SampleBuffer, TheNearestTriangleIsKeptInAnyOrder) {
  const Corners far = {{{0, 0, 0.5f}, {90 * parts, 0, 0.5f}, {0, 60 * parts, 0.5f}}},
                near = {{{0, 0, 0.2f}, {90 * parts, 0, 0.8f}, {0, 60 * parts, 0.8f}}};
  SampleBuffer one(width, height, 4), other(width, height, 4);
  one.fill(far, 1, Facing::towards, Samples::all);
  one.fill(near, 2, Facing::towards, Samples::all);
  other.fill(near, 2, Facing::towards, Samples::all);
  other.fill(far, 1, Facing::towards, Samples::all);
  int of_each[3] = {};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int s = 0; s < 4; ++s) {
        EXPECT_EQ(one.numbers(x, y)[s], other.numbers(x, y)[s]);
        ++of_each[one.numbers(x, y)[s]];
      }
    }
  }
  EXPECT_GT(of_each[1], 1000);
  EXPECT_GT(of_each[2], 1000);
}

TEST(SampleBuffer, FarSidesAndEverySecondSampleAreLeftOutOnRequest) {
  const Corners corners = {{{0, 0, 1}, {90 * parts, 0, 1}, {0, 60 * parts, 1}}},
                turned = {{corners[0], corners[2], corners[1]}};
  SampleBuffer buffer(width, height, 4);
  buffer.fill(turned, 1, Facing::towards, Samples::all);
  EXPECT_EQ(buffer.numbers(5, 5)[0], 0u);
  buffer.fill(turned, 1, Facing::both, Samples::every_second);
  for (int s = 0; s < 4; ++s) EXPECT_EQ(buffer.numbers(5, 5)[s], s % 2 == 0 ? 1u : 0u);
  buffer.clear(5, 5, 6);
  EXPECT_EQ(buffer.numbers(5, 5)[0], 0u);
  EXPECT_EQ(buffer.numbers(6, 5)[0], 1u);
}

const Camera camera = {Vec3(0, 0.5, 4), Vec3(0, 0.5, 0), 30};

Eigen::Matrix4f view() { return view_matrix(camera, double(width) / height, Vec3::Zero(), 2); }

DrawMesh square_mesh() {
  DrawMesh mesh;
  mesh.triangles = {0, 1, 2, 0, 2, 3};
  mesh.occlusion = {1, 1, 1, 1};
  return mesh;
}

std::vector<float> square_at(float left, float right, float low, float high, float z) {
  return {left, low, z, right, low, z, right, high, z, left, high, z};
}

void find(Visibility& visibility, const std::vector<DrawMesh>& meshes,
          const std::vector<std::vector<float>>& positions) {
  visibility.find(meshes, positions, view(), nearest_seen(camera, Vec3::Zero(), 2),
                  rays_through(camera, width, height).up.norm());
}

TEST(Visibility, APixelOnABorderShowsTwoSurfacesWithTheirSamples) {
  const std::vector<DrawMesh> meshes = {square_mesh(), square_mesh()};
  Visibility visibility(width, height, 4, meshes);
  find(visibility, meshes, {square_at(-3, 0.002f, 0.1f, 3, -1), square_at(-0.3f, 0.3f, 0.3f, 0.7f, 0)});
  int one = 0, two = 0, partly = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!visibility.tiles().marked(x / Tiles::edge, y / Tiles::edge)) continue;
      const std::uint32_t* seen = &visibility.surfaces()[2 * (std::size_t(y) * width + x)];
      const std::uint32_t first = seen[0] >> 24, second = seen[1] >> 24;
      ASSERT_EQ(first & second, 0u);
      ASSERT_EQ(first == 0, (seen[0] & 0xffffffu) == 0);
      ASSERT_EQ(second == 0, (seen[1] & 0xffffffu) == 0);
      for (const std::uint32_t number : {seen[0], seen[1]}) ASSERT_LE(number & 0xffffffu, 4u);
      // The two triangles of a square are one surface.
      const auto mesh = [](std::uint32_t number) { return ((number & 0xffffffu) + 1) / 2; };
      ASSERT_TRUE(second == 0 || mesh(seen[0]) != mesh(seen[1]));
      one += first == 15 ? 1 : 0;
      two += second != 0 && (first | second) == 15 ? 1 : 0;
      partly += first != 0 && (first | second) != 15 ? 1 : 0;
    }
  }
  EXPECT_GT(one, 1000);
  EXPECT_GT(two, 10);
  EXPECT_GT(partly, 10);
}

TEST(Visibility, FullTilesAreThoseInWhichAllSamplesShowSomething) {
  const std::vector<DrawMesh> meshes = {square_mesh()};
  Visibility visibility(width, height, 4, meshes);
  find(visibility, meshes, {square_at(-1.5f, 1.5f, 0.01f, 1.5f, 0)});
  int full = 0;
  for (int row = 0; row < visibility.full().rows(); ++row) {
    for (int column = 0; column < visibility.full().columns(); ++column) {
      bool covered = visibility.tiles().marked(column, row);
      for (int y = row * Tiles::edge; covered && y < std::min(height, (row + 1) * Tiles::edge); ++y) {
        for (int x = column * Tiles::edge; x < std::min(width, (column + 1) * Tiles::edge); ++x)
          covered = covered && visibility.surfaces()[2 * (std::size_t(y) * width + x)] >> 24 == 15;
      }
      EXPECT_EQ(visibility.full().marked(column, row), covered) << column << ", " << row;
      full += covered ? 1 : 0;
    }
  }
  EXPECT_GE(full, 4);
  EXPECT_LT(full, visibility.full().rows() * visibility.full().columns());
  find(visibility, meshes, {square_at(9, 10, 0.1f, 0.9f, 0)});
  EXPECT_EQ(visibility.tiles().around().width, 0) << "the frame before is still there";
  const std::vector<DrawMesh> others = {square_mesh(), square_mesh(), square_mesh()};
  visibility.renew(others);
  find(visibility, others, {square_at(9, 10, 1, 2, 0), square_at(9, 10, 1, 2, 0), square_at(-1, 1, 0.01f, 1.5f, 0)});
  const std::uint32_t seen = visibility.surfaces()[2 * (std::size_t(height / 2) * width + width / 2)] & 0xffffffu;
  EXPECT_TRUE(seen == 5 || seen == 6) << seen;
}

// A plane that begins behind the camera is seen as if it began before it: its far part alone shows the same.
TEST(Visibility, WhatReachesBehindTheCameraIsCut) {
  const std::vector<DrawMesh> meshes = {square_mesh()};
  const auto plane = [](float from) {
    return std::vector<float>{-40, 0.1f, from, 40, 0.1f, from, 40, 0.1f, -30, -40, 0.1f, -30};
  };
  Visibility whole(width, height, 4, meshes), part(width, height, 4, meshes);
  find(whole, meshes, {plane(60)});
  find(part, meshes, {plane(3.5f)});  // nearer places are below the picture
  int seen = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool covered = whole.distance(x, y) < 1e9;
      ASSERT_EQ(covered, part.distance(x, y) < 1e9) << x << ", " << y;
      seen += covered ? 1 : 0;
      if (!covered) continue;
      ASSERT_NEAR(whole.distance(x, y), part.distance(x, y), 1e-2 * part.distance(x, y));
    }
  }
  EXPECT_GT(seen, width * height / 4);
}

TEST(Visibility, WhatLiesBelowTheGroundIsNotSeen) {
  std::vector<DrawMesh> meshes = {square_mesh()};
  meshes[0].two_sided = true;
  Visibility visibility(width, height, 1, meshes);
  find(visibility, meshes, {square_at(-0.5f, 0.5f, -0.5f, 0.5f, 0)});
  const Rays rays = rays_through(camera, width, height);
  for (int y = 0; y < height; ++y) {
    const double up = (camera.eye + 4 * (rays.corner + 0.5 * width * rays.right + (y + 0.5) * rays.up)).y();
    if (std::abs(up) < 0.03 || std::abs(up - 0.5) < 0.03) continue;
    EXPECT_EQ(visibility.distance(width / 2, y) < 1e9, up > 0 && up < 0.5) << "at a height of " << up;
  }
}

// Returns how many samples show the second of two meshes: a level cloth of a metre, seen from slightly above, and a bar
// that lies across below it and of which an edge comes through by a height [m].
int samples_of_bar(double through, bool cloth) {
  std::vector<DrawMesh> meshes = {square_mesh(), square_mesh()};
  for (DrawMesh& mesh : meshes) mesh.two_sided = true;
  meshes[0].kept_clear = cloth;
  for (const Vec3& corner : {Vec3(-0.5, 0.3, -0.5), Vec3(0.5, 0.3, 0.5)}) meshes[0].rest.include(corner);
  const auto top = static_cast<float>(0.3 + through);
  const std::vector<std::vector<float>> positions = {
      {-0.5f, 0.3f, 0.5f, 0.5f, 0.3f, 0.5f, 0.5f, 0.3f, -0.5f, -0.5f, 0.3f, -0.5f},
      square_at(-0.4f, 0.4f, 0.25f, top, 0)};
  constexpr int fine_width = 800, fine_height = 500;
  const Camera low = {Vec3(0, 0.9, 2.4), Vec3(0, 0.3, 0), 30};
  Visibility visibility(fine_width, fine_height, 4, meshes);
  visibility.find(meshes, positions, view_matrix(low, double(fine_width) / fine_height, Vec3::Zero(), 2),
                  nearest_seen(low, Vec3::Zero(), 2), rays_through(low, fine_width, fine_height).up.norm());
  int seen = 0;
  for (std::size_t i = 0; i < visibility.surfaces().size(); ++i)
    seen += visibility.tiles().marked(int(i / 2 % fine_width) / Tiles::edge, int(i / 2 / fine_width) / Tiles::edge) &&
                    (visibility.surfaces()[i] & 0xffffffu) > 2
                ? 1
                : 0;
  return seen;
}

TEST(Visibility, AClothIsSeenWhereItCutsALittleIntoWhatItLiesOn) {
  EXPECT_EQ(samples_of_bar(0.0015, true), 0);
  EXPECT_GT(samples_of_bar(0.0015, false), 100) << "the bar is too thin to be seen in any case";
  EXPECT_GT(samples_of_bar(0.02, true), 1000) << "what stands out of a cloth is seen";
}

// What is lifted counts as nearer than it is against others, and not against what is lifted more or less.
TEST(Visibility, LiftedTrianglesHideEachOtherByWhereTheyAre) {
  const auto at = [](float nearness) {
    return std::array{ScreenCorner{-9000, -9000, nearness}, ScreenCorner{9000, -9000, nearness},
                      ScreenCorner{0, 9000, nearness}};
  };
  SampleBuffer buffer(8, 8, 4);
  const auto seen = [&buffer] { return buffer.numbers(4, 4)[0]; };
  buffer.fill(at(1), 1, Facing::both, Samples::all);
  buffer.fill_lifted(at(0.9f), 2, 1.05f);
  EXPECT_EQ(seen(), 1u);
  buffer.fill_lifted(at(0.97f), 3, 1.05f);
  EXPECT_EQ(seen(), 3u) << "it lies below the first, but less than it is lifted";
  buffer.fill_lifted(at(0.96f), 4, 1.5f);
  EXPECT_EQ(seen(), 3u) << "a far side is lifted more, and still behind";
  buffer.fill_lifted(at(0.98f), 5, 1.03f);
  EXPECT_EQ(seen(), 5u);
  EXPECT_NEAR(std::abs(buffer.nearness(4, 4)[0]), 0.98, 1e-6);
}

}  // namespace visibility_test
}  // namespace supple
