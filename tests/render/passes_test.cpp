// Tests the passes of pictures against the geometry that they tell of: planes, balls, and places in the next picture.
#include "render/passes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/projection.h"
#include "render/view.h"

namespace supple {
namespace passes_test {

constexpr int width = 96, height = 64;
constexpr double reach = 20;  // [m]

// Holds meshes that are written by hand, and their positions.
struct Scenery {
  std::vector<DrawMesh> meshes;
  DrawList list;

  Scenery() { list.camera = {Vec3(0.4, 1.5, 3), Vec3(0, 0.5, 0), 40}; }

  void add(const std::string& name, const std::vector<Vec3>& points, const std::vector<std::uint32_t>& triangles) {
    DrawMesh mesh;
    mesh.name = name;
    mesh.triangles = triangles;
    mesh.occlusion.assign(points.size(), 1);
    mesh.two_sided = true;
    std::vector<float> places;
    for (const Vec3& point : points) {
      mesh.rest.include(point);
      for (int k = 0; k < 3; ++k) places.push_back(static_cast<float>(point[k]));
    }
    meshes.push_back(std::move(mesh));
    list.positions.push_back(std::move(places));
  }
  void add_square(const std::string& name, const Vec3& middle, const Vec3& along, const Vec3& across) {
    add(name, {middle - along - across, middle + along - across, middle + along + across, middle - along + across},
        {0, 1, 2, 0, 2, 3});
  }

  std::vector<PassImage> passes(const std::vector<PicturePass>& asked, const DrawList* next = nullptr,
                                bool ground = false) const {
    Visibility visibility(width, height, 4, meshes);
    const Eigen::Matrix4f view = view_matrix(list.camera, double(width) / height, Vec3::Zero(), reach);
    visibility.find(meshes, list.positions, view, nearest_seen(list.camera, Vec3::Zero(), reach),
                    rays_through(list.camera, width, height).up.norm());
    return passes_of({meshes, list, next, visibility, width, height, ground}, asked);
  }
};

Vec3 vector_at(const PassImage& image, std::size_t pixel) {
  return {image.values[3 * pixel], image.values[3 * pixel + 1], image.values[3 * pixel + 2]};
}

// Returns the ray through the middle of a pixel whose rows count from the top; it has length one along the view.
Vec3 ray_at(const Camera& camera, std::size_t pixel) {
  const Rays rays = rays_through(camera, width, height);
  const auto row = static_cast<int>(pixel) / width;
  return rays.corner + (static_cast<int>(pixel) % width + 0.5) * rays.right + (height - 1 - row + 0.5) * rays.up;
}

constexpr PicturePass all[] = {PicturePass::depth, PicturePass::normals, PicturePass::masks, PicturePass::motion,
                               PicturePass::positions};

TEST(Passes, OfAPlaneAreWhereTheRaysMeetIt) {
  Scenery scenery;
  const Vec3 middle(0, 0.8, 0), along(0.9, 0.1, -0.2), across(0.1, 0.5, -0.4);
  scenery.add_square("board", middle, along, across);
  const std::vector<PassImage> passes = scenery.passes({std::begin(all), std::end(all)});
  ASSERT_EQ(passes.size(), 5U);
  const Vec3 normal = along.cross(across).normalized(), eye = scenery.list.camera.eye;
  int whole = 0, none = 0;
  for (std::size_t pixel = 0; pixel < std::size_t(width) * height; ++pixel) {
    const float mask = passes[2].values[pixel];
    if (mask == 0) {
      ++none;
      EXPECT_EQ(passes[0].values[pixel], no_depth);
      EXPECT_EQ(vector_at(passes[1], pixel).norm() + vector_at(passes[4], pixel).norm(), 0);
    }
    if (mask < 1) continue;
    ++whole;
    const Vec3 ray = ray_at(scenery.list.camera, pixel);
    const double depth = normal.dot(middle - eye) / normal.dot(ray);
    EXPECT_NEAR(passes[0].values[pixel], depth, 1e-5 * depth);
    EXPECT_LT((vector_at(passes[4], pixel) - (eye + depth * ray)).norm(), 1e-5);
    EXPECT_LT((vector_at(passes[1], pixel) - normal).norm(), 1e-5);
    EXPECT_EQ(vector_at(passes[3], pixel).norm(), 0) << "there is no next picture";
  }
  EXPECT_GT(whole, 800);
  EXPECT_GT(none, 800);
}

TEST(Passes, MasksShareEachPixelBetweenTheBodiesThatItShows) {
  Scenery scenery;
  scenery.add_square("front", Vec3(0.2, 0.8, 0.5), Vec3(0.4, 0, 0), Vec3(0.05, 0.3, 0));
  scenery.add_square("back", Vec3(0, 0.8, 0), Vec3(0.8, 0.03, 0), Vec3(0, 0.4, 0));
  const std::vector<PassImage> masks = scenery.passes({PicturePass::masks});
  ASSERT_EQ(masks.size(), 2U);
  EXPECT_EQ(masks[0].mesh, "front");
  const std::vector<float> alone = [&] {
    Scenery one;
    one.add_square("front", Vec3(0.2, 0.8, 0.5), Vec3(0.4, 0, 0), Vec3(0.05, 0.3, 0));
    return one.passes({PicturePass::masks})[0].values;
  }();
  EXPECT_EQ(masks[0].values, alone) << "what is in front hides nothing of it";
  int shared = 0, hidden = 0;
  for (std::size_t pixel = 0; pixel < alone.size(); ++pixel) {
    const float front = masks[0].values[pixel], back = masks[1].values[pixel];
    EXPECT_LE(front + back, 1);
    shared += front > 0 && back > 0 && front + back == 1 ? 1 : 0;
    hidden += front == 1 && back == 0 ? 1 : 0;
  }
  EXPECT_GT(shared, 30);
  EXPECT_GT(hidden, 300);
}

TEST(Passes, NormalsOfABallPointAwayFromItsMiddle) {
  Scenery scenery;
  const Vec3 middle(0, 0.7, 0);
  std::vector<Vec3> points;
  std::vector<std::uint32_t> triangles;
  constexpr std::uint32_t rows = 24, columns = 48;
  for (std::uint32_t r = 0; r <= rows; ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      const double down = std::numbers::pi * r / rows, around = 2 * std::numbers::pi * c / columns;
      points.push_back(
          middle + 0.6 * Vec3(std::sin(down) * std::cos(around), std::cos(down), -std::sin(down) * std::sin(around)));
      const std::uint32_t a = r * columns + c, b = r * columns + (c + 1) % columns;
      if (r < rows) triangles.insert(triangles.end(), {a, a + columns, b, b, a + columns, b + columns});
    }
  }
  scenery.add("ball", points, triangles);
  const std::vector<PassImage> passes =
      scenery.passes({PicturePass::normals, PicturePass::positions, PicturePass::masks});
  int whole = 0;
  for (std::size_t pixel = 0; pixel < std::size_t(width) * height; ++pixel) {
    if (passes[2].values[pixel] < 1) continue;
    const Vec3 away = (vector_at(passes[1], pixel) - middle).normalized(), normal = vector_at(passes[0], pixel);
    EXPECT_NEAR(normal.norm(), 1, 1e-5);
    // At the poles, many thin triangles meet.
    if (std::abs(away.y()) < 0.9) {
      EXPECT_GT(normal.dot(away), 0.998);
    }
    ++whole;
  }
  EXPECT_GT(whole, 500);
}

TEST(Passes, MotionLeadsToThePlaceInTheNextPicture) {
  Scenery scenery;
  scenery.add_square("board", Vec3(0, 0.8, 0), Vec3(0.7, 0.1, -0.2), Vec3(0.1, 0.5, -0.3));
  DrawList next = scenery.list;
  next.camera.eye += Vec3(0.1, -0.05, 0.2);
  const Vec3 moved(0.08, 0.03, -0.05);
  for (std::size_t i = 0; i < next.positions[0].size(); ++i)
    next.positions[0][i] += static_cast<float>(moved[static_cast<Eigen::Index>(i % 3)]);
  const std::vector<PassImage> passes =
      scenery.passes({PicturePass::masks, PicturePass::motion, PicturePass::positions}, &next, true);
  Bounds around;
  around.include(Vec3(-5, -5, -5));
  around.include(Vec3(5, 5, 5));
  const Projection now(scenery.list.camera, around, width, height), then(next.camera, around, width, height);
  int bodies = 0, grounds = 0;
  for (std::size_t pixel = 0; pixel < std::size_t(width) * height; ++pixel) {
    const float mask = passes[0].values[pixel];
    const Vec3 place = vector_at(passes[2], pixel);
    if (place.norm() == 0 || place.norm() > 4 || (mask > 0 && mask < 1)) continue;
    const auto from = now(place), to = then(mask > 0 ? Vec3(place + moved) : place);
    ASSERT_TRUE(from && to);
    const Vec3 motion = vector_at(passes[1], pixel);
    EXPECT_NEAR(motion.x(), to->x() - from->x(), 2e-3);
    EXPECT_NEAR(motion.y(), from->y() - to->y(), 2e-3) << "a picture's rows count downwards";
    EXPECT_GT(motion.norm(), 0);
    (mask > 0 ? bodies : grounds) += 1;
  }
  EXPECT_GT(bodies, 500);
  EXPECT_GT(grounds, 500);
}

TEST(Passes, HaveTheGroundWherePicturesHaveIt) {
  Scenery scenery;
  scenery.add_square("board", Vec3(0, 0.8, 0), Vec3(0.3, 0, 0), Vec3(0, 0.2, 0));
  const std::vector<PicturePass> asked = {PicturePass::depth, PicturePass::normals, PicturePass::positions,
                                          PicturePass::masks};
  const std::vector<PassImage> with = scenery.passes(asked, nullptr, true), without = scenery.passes(asked);
  int grounds = 0, skies = 0;
  for (std::size_t pixel = 0; pixel < std::size_t(width) * height; ++pixel) {
    if (with[3].values[pixel] > 0) {
      EXPECT_EQ(with[0].values[pixel], without[0].values[pixel]);
      continue;
    }
    EXPECT_EQ(without[0].values[pixel], no_depth);
    const Vec3 ray = ray_at(scenery.list.camera, pixel), eye = scenery.list.camera.eye;
    if (ray.y() >= 0) {
      EXPECT_EQ(with[0].values[pixel], no_depth);
      ++skies;
      continue;
    }
    EXPECT_NEAR(with[0].values[pixel], -eye.y() / ray.y(), 1e-5 * -eye.y() / ray.y());
    EXPECT_EQ(vector_at(with[1], pixel), Vec3(0, 1, 0));
    EXPECT_EQ(vector_at(with[2], pixel).y(), 0);
    ++grounds;
  }
  EXPECT_GT(grounds, 1000);
  EXPECT_GT(skies, 100);
}

// A replay may give a collider another shape, whose triangles tell nothing of where the first ones have gone.
TEST(Passes, AMeshWithOtherTrianglesInTheNextPictureStands) {
  Scenery scenery;
  scenery.add_square("board", Vec3(0, 0.8, 0), Vec3(0.7, 0, 0), Vec3(0, 0.5, 0));
  DrawList next = scenery.list;
  for (float& number : next.positions[0]) number += 1;
  DrawMesh other = scenery.meshes[0];
  std::swap(other.triangles[0], other.triangles[1]);
  EXPECT_GT(vector_at(scenery.passes({PicturePass::motion}, &next)[0], width * height / 2 + width / 2).norm(), 1);
  next.renewed.emplace_back(0, other);
  EXPECT_LT(vector_at(scenery.passes({PicturePass::motion}, &next)[0], width * height / 2 + width / 2).norm(), 1e-9);
}

TEST(Passes, LeaveGhostsOut) {
  Scenery scenery;
  scenery.add_square("", Vec3(0.2, 0.8, 0.5), Vec3(0.9, 0, 0), Vec3(0, 0.6, 0));
  scenery.meshes[0].ghost = true;
  scenery.add_square("board", Vec3(0, 0.8, 0), Vec3(0.8, 0, 0), Vec3(0, 0.5, 0));
  const std::vector<PassImage> passes = scenery.passes({PicturePass::masks, PicturePass::depth});
  ASSERT_EQ(passes.size(), 2U);
  const std::size_t middle = width * height / 2 + width / 2;
  EXPECT_EQ(passes[0].values[middle], 0.5) << "the ghost takes every second sample";
  const Vec3 ray = ray_at(scenery.list.camera, middle);
  EXPECT_NEAR(passes[1].values[middle], -scenery.list.camera.eye.z() / ray.z(), 0.02);
}

}  // namespace passes_test
}  // namespace supple
