// Tests that what a skin has outside all elements stretches no more than it may, and that nothing else moves.
#include "geometry/skins/skin_limit.h"

#include <gtest/gtest.h>

#include "geometry/tetrahedra/tetrahedralize.h"
#include "support/surfaces.h"

namespace supple {
namespace skin_limit_test {

// Makes a ball with so few vertices that most of its skin lies outside. The skin's first vertex is in it twice, as at a
// crease.
struct CreasedBall {
  CreasedBall() {
    Shape shape;
    ShapePart part;
    part.primitive = Sphere{1};
    shape.root.parts.push_back(part);
    mesh = tetrahedralize(shape, 100, "ball");
    skin = test::sphere_surface(1, 60, 40);
    const Eigen::Index copy = skin.points.rows();
    skin.points.conservativeResize(copy + 1, 3);
    skin.points.row(copy) = skin.points.row(0);
    bool first = true;
    for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (skin.triangles(t, k) != 0) continue;
        if (!first) skin.triangles(t, k) = std::int32_t(copy);
        first = false;
      }
    }
    embedding = embed(skin, mesh);
  }
  TetMesh mesh;
  TriMesh skin;
  Embedding embedding;
};

TEST(SkinLimit, BringsBackWhatIsTornOutAndNothingElse) {
  const CreasedBall ball;
  ASSERT_TRUE(ball.embedding.outside(0));
  const std::optional<SkinLimit> limit = skin_limit(ball.skin, ball.embedding);
  ASSERT_TRUE(limit);
  EXPECT_NEAR(limit->largest_stretch(ball.skin.points), 1, 1e-12);
  const Eigen::Index copy = ball.skin.points.rows() - 1;
  const Vec3 out = 1.7 * ball.skin.points.row(0);
  Positions torn = ball.skin.points;
  torn.row(0) = torn.row(copy) = out;
  EXPECT_GT(limit->largest_stretch(torn), 5);
  limit->apply(1.3, torn);
  EXPECT_LE(limit->largest_stretch(torn), 1.3 * 1.01);
  EXPECT_EQ(torn.row(0), torn.row(copy));
  Eigen::Index moved = 0;
  for (Eigen::Index v = 0; v < torn.rows(); ++v) {
    if (torn.row(v) == ball.skin.points.row(v)) continue;
    ++moved;
    EXPECT_TRUE(ball.embedding.outside(v));
    EXPECT_LT((torn.row(v) - ball.skin.points.row(0)).norm(), 0.7) << "far from where it is torn";
  }
  EXPECT_GE(moved, 2);
}

TEST(SkinLimit, LeavesWhatIsShortEnoughToTheBit) {
  const CreasedBall ball;
  const std::optional<SkinLimit> limit = skin_limit(ball.skin, ball.embedding);
  ASSERT_TRUE(limit);
  const Positions before = 1.2 * ball.skin.points;
  Positions after = before;
  limit->apply(1.25, after);
  EXPECT_TRUE(after == before);
}

// Two parts that have gone apart hold a strip between them that is too short: first its middle moves, then its ends,
// which lie in elements, come together as far as they must.
TEST(SkinLimit, DrawsTogetherWhatAStripCannotSpan) {
  TriMesh strip;
  strip.points.resize(6, 3);
  strip.points << 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0, 2, 1, 0;
  strip.triangles.resize(4, 3);
  strip.triangles << 0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5;
  Embedding embedding;
  embedding.corners = Tetrahedra::Zero(6, 4);
  embedding.begin = {0, 0, 0, 1, 2, 2, 2};  // its middle lies outside
  embedding.shares = {{0, 1}, {0, 1}};
  const std::optional<SkinLimit> limit = skin_limit(strip, embedding);
  ASSERT_TRUE(limit);
  for (const double end : {2.8, 12.0}) {
    Positions apart = strip.points;
    apart.row(4).x() = apart.row(5).x() = end;
    const Positions before = apart;
    limit->apply(1.5, apart);
    EXPECT_LE(limit->largest_stretch(apart), 1.5 * 1.01);
    for (const int k : {0, 1, 4, 5}) {
      if (end < 3)
        EXPECT_EQ(apart.row(k), before.row(k));
      else
        EXPECT_NE(apart.row(k), before.row(k));
    }
    for (const int k : {2, 3}) EXPECT_NEAR(apart(k, 0), end / 2, 0.2 * end);
  }
}

TEST(SkinLimit, IsNotThereWhereAllLiesInElements) {
  CreasedBall ball;
  ball.embedding = embed(TriMesh{0.3 * ball.skin.points, ball.skin.triangles}, ball.mesh);
  EXPECT_FALSE(skin_limit(ball.skin, ball.embedding));
}

}  // namespace skin_limit_test
}  // namespace supple
