#include "geometry/skins/simplify.h"

#include <gtest/gtest.h>

#include <map>

#include "support/surfaces.h"

namespace supple {
namespace simplify_test {

Skin skin_of(const TriMesh& mesh) {
  Skin skin;
  skin.rest = mesh;
  skin.occlusion.assign(mesh.points.rows(), 1.0f);
  skin.paint.resize(mesh.points.rows());
  for (auto& distances : skin.paint) distances.fill(1e3f);
  return skin;
}

// The tests below use this torus, whose surface is known by formula [m].
constexpr double radius = 0.5, tube = 0.2;

double off_torus(const Vec3& p) { return std::abs(std::hypot(std::hypot(p.x(), p.z()) - radius, p.y()) - tube); }

TEST(Simplify, ASmoothSurfaceKeepsItsShapeAndItsClosednessWithFewerTriangles) {
  Skin skin = skin_of(test::torus_surface(radius, tube, 240, 120));
  const Eigen::Index before = skin.rest.triangles.rows();
  const double error = 0.002, longest = 0.08;
  skin.rest.triangles = simplified(skin, error, longest, {});
  EXPECT_LT(skin.rest.triangles.rows(), before / 5);
  std::map<std::pair<int, int>, int> edges;  // how often each is used in its direction
  for (Eigen::Index t = 0; t < skin.rest.triangles.rows(); ++t) {
    Vec3 middle = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const int from = skin.rest.triangles(t, k), to = skin.rest.triangles(t, (k + 1) % 3);
      ++edges[{from, to}];
      const Vec3 a = skin.rest.points.row(from), b = skin.rest.points.row(to);
      EXPECT_LT((a - b).norm(), 2.5 * longest);
      EXPECT_LT(off_torus(0.5 * (a + b)), 1.5 * error);
      middle += a / 3;
    }
    EXPECT_LT(off_torus(middle), 1.5 * error);
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u) << "an open edge";
  }
}

TEST(Simplify, TrianglesOnTheBorderOfALayerStay) {
  Skin skin = skin_of(test::torus_surface(radius, tube, 120, 60));
  PaintLayer layer;
  layer.soft = 0.01;
  for (Eigen::Index v = 0; v < skin.rest.points.rows(); ++v)
    skin.paint[v][0] = static_cast<float>(skin.rest.points(v, 0));  // the border is the plane x = 0
  const auto crossing = [](const Skin& s) {
    int count = 0;
    for (Eigen::Index t = 0; t < s.rest.triangles.rows(); ++t) {
      int negative = 0;
      for (int k = 0; k < 3; ++k) negative += s.paint[s.rest.triangles(t, k)][0] < 0 ? 1 : 0;
      count += negative % 3 == 0 ? 0 : 1;
    }
    return count;
  };
  const int before = crossing(skin);
  const Eigen::Index all = skin.rest.triangles.rows();
  skin.rest.triangles = simplified(skin, 0.005, 0.2, {layer});
  EXPECT_EQ(crossing(skin), before);
  EXPECT_LT(skin.rest.triangles.rows(), all / 2);
}

TEST(Simplify, UnusedVerticesGoAndTheOthersKeepTheirValues) {
  Skin skin = skin_of(test::torus_surface(radius, tube, 60, 30));
  for (std::size_t v = 0; v < skin.occlusion.size(); ++v) skin.occlusion[v] = static_cast<float>(v);
  skin.rest.triangles = simplified(skin, 0.01, 0.3, {});
  const Skin whole = skin;
  const std::vector<std::int32_t> kept = remove_unused_vertices(skin);
  ASSERT_EQ(skin.rest.points.rows(), Eigen::Index(kept.size()));
  ASSERT_LT(kept.size(), whole.occlusion.size());
  for (std::size_t v = 0; v < kept.size(); ++v) EXPECT_EQ(skin.occlusion[v], static_cast<float>(kept[v]));
  for (Eigen::Index i = 0; i < skin.rest.triangles.size(); ++i) {
    EXPECT_EQ(skin.rest.points.row(skin.rest.triangles.data()[i]),
              whole.rest.points.row(whole.rest.triangles.data()[i]));
  }
}

}  // namespace simplify_test
}  // namespace supple
