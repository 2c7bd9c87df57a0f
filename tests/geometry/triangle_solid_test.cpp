// Tests closest points against brute force, signs against formulas, and normals at all places where they could fail.
#include "geometry/solids/triangle_solid.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <random>

#include "support/surfaces.h"

namespace supple {
namespace triangle_solid_test {

// The plain version follows Ericson, Real-Time Collision Detection, 2005, section 5.1.5, region by region.
Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
  return a + vb / (va + vb + vc) * ab + vc / (va + vb + vc) * ac;
}

double distance_by_brute_force(const TriMesh& mesh, const Vec3& p) {
  double smallest = std::numeric_limits<double>::infinity();
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const auto corner = [&](int k) -> Vec3 { return mesh.points.row(mesh.triangles(t, k)); };
    smallest = std::min(smallest, (p - closest_on_triangle(p, corner(0), corner(1), corner(2))).squaredNorm());
  }
  return std::sqrt(smallest);
}

class Points {
 public:
  explicit Points(unsigned seed) : random_(seed) {}
  Vec3 in_box(const Vec3& half) {
    return half.cwiseProduct(Vec3(uniform_(random_), uniform_(random_), uniform_(random_)));
  }
  Vec3 near_surface(const TriMesh& mesh, double amount) {
    const auto t = Eigen::Index(random_() % std::uint64_t(mesh.triangles.rows()));
    Vec3 weight = in_box(Vec3::Ones()).cwiseAbs() + Vec3::Constant(1e-9);
    weight /= weight.sum();
    Vec3 p = amount * in_box(Vec3::Ones());
    for (int k = 0; k < 3; ++k) p += weight[k] * mesh.points.row(mesh.triangles(t, k)).transpose();
    return p;
  }

 private:
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

TEST(TriangleSolid, FindsTheClosestPointThatBruteForceFinds) {
  TriMesh slivers = test::sphere_surface(1, 12, 5);
  slivers.points *= Vec3(1, 1e-3, 1e-7).asDiagonal();
  const struct {
    const char* name;
    TriMesh mesh;
    int queries;
    // In a sliver, round-off leads the plain version to a point of the triangle that isn't the closest.
    bool plain_is_exact;
  } cases[] = {{"torus", test::torus_surface(1, 0.4, 63, 16), 20'000, true},
               {"box", test::box_surface(Vec3(1, 0.5, 0.25)), 500'000, true},
               {"needle", test::box_surface(Vec3(1, 1e-3, 1e-8)), 300'000, false},
               {"slivers", slivers, 100'000, false},
               {"triangle", {test::box_surface(Vec3(1, 1, 1)).points, Triangles{{0, 4, 6}}}, 80'000, true}};
  for (const auto& [name, mesh, queries, plain_is_exact] : cases) {
    const TriangleSolid solid(mesh);
    Points points(3);
    double worst = 0, off = 0, slope = 0;
    for (int i = 0; i < queries; ++i) {
      const Vec3 p = i % 2 ? points.in_box(Vec3::Constant(2)) : points.near_surface(mesh, i % 4 ? 1e-2 : 1e-7);
      const SurfacePoint found = solid.closest(p);
      const double excess = std::abs(found.distance) - distance_by_brute_force(mesh, p);
      worst = std::max(worst, plain_is_exact ? std::abs(excess) : excess);
      off = std::max(off, std::abs((p - found.point).norm() - std::abs(found.distance)));
      slope = std::max(slope, std::abs(found.normal.norm() - 1));
    }
    EXPECT_LT(worst, 1e-14) << name;
    EXPECT_LT(off, 1e-14) << name;
    EXPECT_LT(slope, 1e-14) << name;
  }
}

// The corners nearly lie on one line, askew in space: round-off moves the plain version's foot along the needle.
TEST(TriangleSolid, FindsPointsOfNeedlesOnThem) {
  Points points(11);
  for (int i = 0; i < 2000; ++i) {
    TriMesh needle{Positions(3, 3), Triangles{{0, 1, 2}}};
    const Vec3 a = points.in_box(Vec3::Ones()), b = points.in_box(Vec3::Ones());
    needle.points << a.transpose(), b.transpose(), (0.4 * a + 0.6 * b + 1e-9 * points.in_box(Vec3::Ones())).transpose();
    const TriangleSolid solid(needle);
    const Vec3 p = (needle.points.row(0) + needle.points.row(1) + needle.points.row(2)).transpose() / 3;
    EXPECT_LT(std::abs(solid.closest(p).distance), 1e-11) << i;
  }
}

TEST(TriangleSolid, FindsTheClosestPointFromVeryFarAway) {
  const TriangleSolid box(test::box_surface(Vec3(1, 2, 3)));
  for (const double far : {1e3, 1e14, 1e100, 1e160, 1.7e308}) {
    EXPECT_EQ(box.closest(Vec3(0, far, 0)).point.y(), 2) << far;
    EXPECT_EQ(box.closest(Vec3(-far, 0, 0)).point.x(), -1) << far;
    EXPECT_EQ(box.closest(Vec3(0, far, -far)).point.tail<2>(), Eigen::Vector2d(2, -3)) << far;
  }
}

TEST(TriangleSolid, HasTheSignsOfSphereTorusAndBox) {
  const TriangleSolid ball(test::sphere_surface(1, 60, 30)), ring(test::torus_surface(1, 0.4, 80, 40));
  const Vec3 half(1, 0.5, 0.25);
  const TriangleSolid box(test::box_surface(half));
  Points points(4);
  int inside = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 p = points.in_box(Vec3::Constant(1.5));
    const double to_ball = p.norm() - 1, to_ring = std::hypot(std::hypot(p.x(), p.z()) - 1, p.y()) - 0.4;
    // Between the flat faces and the round surface, the two signs differ.
    if (std::abs(to_ball) > 0.01) {
      EXPECT_EQ(ball.closest(p).distance < 0, to_ball < 0) << p.transpose();
    }
    if (std::abs(to_ring) > 0.01) {
      EXPECT_EQ(ring.closest(p).distance < 0, to_ring < 0) << p.transpose();
    }
    const bool in_box = (p.array().abs() < half.array()).all();
    EXPECT_EQ(box.closest(p).distance < 0, in_box) << p.transpose();
    inside += (to_ball < 0) + (to_ring < 0) + in_box;
  }
  EXPECT_GT(inside, 30'000);
}

TEST(TriangleSolid, TheRaysOfQueriesOnTheGridOfTheVerticesSlipNowhere) {
  // Every ray along an axis runs through vertices, along edges or within faces.
  const TriangleSolid box(test::box_surface(Vec3(1, 1, 1)));
  const TriangleSolid two(test::together(test::moved(test::box_surface(Vec3(1, 1, 1)), Vec3(-1, 0, 0)),
                                         test::moved(test::box_surface(Vec3(0.5, 0.5, 0.5)), Vec3(1, 0.5, 0))));
  for (int i = 0; i < 9 * 9 * 9; ++i) {
    const Vec3 p = 0.25 * Vec3(i % 9 - 4, i / 9 % 9 - 4, i / 81 - 4);
    const double to_side = p.cwiseAbs().maxCoeff() - 1;
    EXPECT_EQ(box.closest(p).distance, to_side) << p.transpose();
    const double left = (p - Vec3(-1, 0, 0)).cwiseAbs().maxCoeff() - 1;
    const double right = (p - Vec3(1, 0.5, 0)).cwiseAbs().maxCoeff() - 0.5;
    if (left != 0 && right != 0) {
      EXPECT_EQ(two.closest(p).distance < 0, left < 0 || right < 0) << p.transpose();
    }
  }
}

TEST(TriangleSolid, TakesOverlapsAsAUnionAndCavitiesAsOutside) {
  const TriMesh ball = test::sphere_surface(1, 24, 12);
  const TriangleSolid lens(test::together(ball, test::moved(ball, Vec3(0.7, 0, 0))));
  EXPECT_NEAR(lens.winding_number(Vec3(0.35, 0, 0)), 2, 0.02);
  EXPECT_LT(lens.closest(Vec3(0.35, 0, 0)).distance, 0);
  EXPECT_LT(lens.closest(Vec3(1.02, 0, 0)).distance, 0);  // just outside of one, inside the other
  EXPECT_GT(lens.closest(Vec3(-0.2, 1.2, 0)).distance, 0);
  TriMesh hollow = test::inside_out(ball);
  hollow.points *= 0.5;
  const TriangleSolid shell(test::together(ball, hollow));
  EXPECT_GT(shell.closest(Vec3(0.1, 0, 0)).distance, 0.3);
  EXPECT_LT(shell.closest(Vec3(0.7, 0, 0)).distance, -0.1);
  // The rays that decide the sign agree with the tree of solid angles.
  for (const TriangleSolid* solid : {&lens, &shell}) {
    Points points(5);
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 p = points.in_box(Vec3::Constant(2));
      const double winding = solid->winding_number(p);
      EXPECT_NEAR(winding, std::round(winding), 0.15) << p.transpose();
      EXPECT_EQ(solid->closest(p).distance<0, winding> 0.5) << p.transpose() << ", " << winding;
    }
  }
}

// One missing triangle is closed by lids, forty are left to the tree: in both cases the sign must be the winding
// number's.
TEST(TriangleSolid, HolesFlipNoSignBeyondTheirNeighbourhood) {
  const TriMesh ball = test::sphere_surface(1, 40, 20);
  TriMesh one = ball, many = ball;
  std::vector<Vec3> holes_of_one, holes_of_many;
  const auto pierce = [](TriMesh& mesh, std::vector<Vec3>& holes, Eigen::Index t) {
    Vec3 center = Vec3::Zero();
    for (int k = 0; k < 3; ++k) center += mesh.points.row(mesh.triangles(t, k)).transpose() / 3;
    holes.push_back(center);
    mesh = test::without_triangle(mesh, t);
  };
  pierce(one, holes_of_one, 801);
  for (Eigen::Index t = 30; t < many.triangles.rows() && holes_of_many.size() < 40; t += 33)
    pierce(many, holes_of_many, t);
  for (const auto& [mesh, holes] : {std::pair(one, holes_of_one), std::pair(many, holes_of_many)}) {
    const TriangleSolid solid(mesh);
    Points points(6);
    int checked = 0;
    for (int i = 0; i < 50'000; ++i) {
      const Vec3 p = points.in_box(Vec3::Constant(1.2));
      const double from_ball = p.norm() - 1;
      const bool at_hole =
          std::any_of(holes.begin(), holes.end(), [&](const Vec3& hole) { return (p - hole).norm() < 0.1; });
      if (std::abs(from_ball) < 0.015 || at_hole) continue;
      ++checked;
      EXPECT_EQ(solid.closest(p).distance < 0, from_ball < 0) << p.transpose();
    }
    EXPECT_GT(checked, 25'000);
    // At the hole itself, the sign follows the winding number through 1/2.
    EXPECT_LT(solid.closest(0.97 * holes[0]).distance, 0);
    EXPECT_GT(solid.closest(1.03 * holes[0]).distance, 0);
  }
}

TEST(TriangleSolid, InTheMouthOfAHoleTheSignIsThatOfTheWindingNumber) {
  TriMesh mesh = test::sphere_surface(1, 20, 10);
  std::vector<Eigen::Index> kept;  // all triangles but those of a bent patch
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    if ((mesh.points.row(mesh.triangles(t, 0)) - Eigen::RowVector3d(1, 0, 0)).norm() > 0.4) kept.push_back(t);
  mesh.triangles = Triangles(mesh.triangles(kept, Eigen::all));
  const TriangleSolid solid(mesh);
  Points points(12);
  int inside = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p = Vec3(0.9, 0, 0) + points.in_box(Vec3(0.1, 0.3, 0.3));
    const double winding = solid.winding_number(p);
    if (std::abs(winding - 0.5) < 0.05) continue;
    EXPECT_EQ(solid.closest(p).distance<0, winding> 0.5) << p.transpose() << ", " << winding;
    inside += winding > 0.5;
  }
  EXPECT_GT(inside, 2000);
}

TEST(TriangleSolid, NormalsAreUnitVectorsEverywhere) {
  TriMesh flat = test::sphere_surface(1, 12, 5);
  flat.points *= Vec3(1, 1e-3, 1e-7).asDiagonal();
  const TriMesh meshes[] = {test::box_surface(Vec3(1, 2, 3)), test::torus_surface(1, 0.4, 30, 15), flat,
                            test::moved(test::sphere_surface(1e-3, 20, 10), Vec3(1e4, 0, 0))};
  for (const TriMesh& mesh : meshes) {
    const TriangleSolid solid(mesh);
    const double scale = mesh.points.cwiseAbs().maxCoeff();
    std::vector<Vec3> queries = {Vec3::Zero(),
                                 solid.bounds().center(),
                                 Vec3::Constant(1e-300),
                                 Vec3(1e308, -1.7e308, 0),
                                 Vec3::Constant(1.7e308),
                                 Vec3(0, 1e160, 0),
                                 Vec3(1e20, 1, 1)};
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
      const auto corner = [&](int k) -> Vec3 { return mesh.points.row(mesh.triangles(t, k)); };
      for (const Vec3& p :
           {corner(0), Vec3(0.5 * (corner(0) + corner(1))), Vec3((corner(0) + corner(1) + corner(2)) / 3)}) {
        queries.push_back(p);
        EXPECT_NEAR(solid.closest(p).distance, 0, 1e-14 * scale);
        for (const double step : {1e-16, 1e-12, 1e-9}) queries.push_back(p + step * scale * Vec3(0.6, -0.8, 0));
      }
    }
    for (const Vec3& p : queries) {
      const SurfacePoint found = solid.closest(p);
      EXPECT_NEAR(found.normal.norm(), 1, 1e-14) << p.transpose();
      EXPECT_FALSE(std::isnan(found.distance)) << p.transpose();
      EXPECT_TRUE(found.point.allFinite()) << p.transpose();
      EXPECT_TRUE(std::isfinite(solid.winding_number(p))) << p.transpose();
    }
  }
}

TEST(TriangleSolid, NormalsPointOutOfBothSidesAndOfTheFaceItself) {
  const TriangleSolid box(test::box_surface(Vec3(1, 1, 1)));
  for (const double x : {0.5, 0.999999, 1.0, 1 + 1e-13, 1.000001, 7.0, 1e30}) {
    const SurfacePoint found = box.closest(Vec3(x, 0.2, 0.1));
    EXPECT_LT((found.normal - Vec3::UnitX()).norm(), 1e-9) << x;
    EXPECT_NEAR(found.distance, x - 1, 1e-15 * x) << x;
  }
  const Vec3 corner_normal = box.closest(Vec3(2, 3, 4)).normal;
  EXPECT_LT((corner_normal - Vec3(1, 2, 3).normalized()).norm(), 1e-14);
}

TEST(TriangleSolid, GivesTheSameBitsEachTime) {
  const TriMesh mesh = test::torus_surface(1, 0.4, 30, 15);
  const TriangleSolid a(mesh), b(mesh);
  Points points(7);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = points.in_box(Vec3::Constant(1.5));
    const SurfacePoint from_a = a.closest(p), from_b = b.closest(p);
    EXPECT_TRUE(from_a.point == from_b.point && from_a.normal == from_b.normal && from_a.distance == from_b.distance);
    EXPECT_EQ(a.winding_number(p), b.winding_number(p));
  }
}

// Each solid is asked along a way through it, with jumps. A memory changes no bit of an answer, also where the vertices
// of a regular surface are equally near and where triangles are tiny, and what it takes for certain is so.
TEST(TriangleSolid, AnswersToPlacesNearEachOtherAreThoseToEachAlone) {
  const TriMesh ball = test::sphere_surface(1, 24, 12);
  TriMesh hollow = test::inside_out(ball);
  hollow.points *= 0.5;
  const struct {
    const char* name;
    TriMesh mesh;
  } cases[] = {{"box", test::box_surface(Vec3(1, 0.5, 0.25))},
               {"torus", test::torus_surface(1, 0.4, 60, 30)},
               {"fine ball", test::sphere_surface(1, 200, 100)},
               {"shell", test::together(ball, hollow)},
               {"overlapping balls", test::together(ball, test::moved(ball, Vec3(0.7, 0, 0)))},
               {"ball with a hole", test::without_triangle(ball, 100)}};
  for (const auto& [name, mesh] : cases) {
    const TriangleSolid solid(mesh);
    Points points(8);
    QueryMemory near;
    Vec3 p = Vec3::Zero();
    int inside = 0, certain = 0;
    for (int i = 0; i < 40'000; ++i) {
      p = i % 50 == 0 ? points.in_box(Vec3::Constant(2)) : Vec3(p + points.in_box(Vec3::Constant(0.03)));
      if (i % 3 == 0) p = points.near_surface(mesh, i % 2 ? 1e-3 : 1e-7);
      if (i % 7 == 0) p = (8 * p).array().round() / 8;  // in the solids' planes of symmetry
      const double clear = solid.certain_distance(p, near);
      certain += clear > 0;
      QueryMemory empty;
      const SurfacePoint alone = solid.closest(p), fresh = solid.closest(p, empty), found = solid.closest(p, near);
      EXPECT_TRUE(found.point == fresh.point && found.normal == fresh.normal && found.distance == fresh.distance)
          << name << " " << p.transpose();
      EXPECT_LE(clear, found.distance) << name << " " << p.transpose();
      EXPECT_NEAR(found.distance, alone.distance, 1e-14) << name << " " << p.transpose();
      EXPECT_NEAR((p - found.distance * found.normal - found.point).norm(), 0, 1e-11) << name << " " << p.transpose();
      inside += alone.distance < 0;
    }
    EXPECT_GT(inside, 5000) << name;
    EXPECT_EQ(certain > 500, solid.is_closed()) << name << " " << certain;
  }
}

// A corner of a box is pulled out through the opposite side. The middles of all triangles face the outside, and yet the
// normals tell nothing of the side where the surface crosses itself.
TEST(TriangleSolid, ASurfaceThatCrossesItselfHasTheSidesOfItsWindingNumber) {
  TriMesh pulled = test::box_surface(Vec3(1, 1, 1));
  pulled.points.row(7) << -1.5, -0.5, -0.25;
  const TriangleSolid solid(pulled);
  Points points(4);
  int inside = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p = points.in_box(Vec3::Constant(2));
    const double winding = solid.winding_number(p);
    QueryMemory memory;
    const SurfacePoint found = solid.closest(p, memory);
    EXPECT_EQ(found.distance<0, winding> 0.5) << p.transpose() << " " << winding;
    inside += winding > 0.5;
  }
  EXPECT_GT(inside, 300);
}

TEST(TriangleSolid, TheLeavesThatAreNearHoldTheClosestTriangle) {
  const TriangleSolid solid(test::sphere_surface(1, 60, 30));
  Points points(6);
  int found = 0;
  for (int i = 0; i < 5'000; ++i) {
    const Vec3 p = points.near_surface(solid.surface(), 0.05);
    NearLeaves leaves;
    if (!solid.find_leaves(p, std::abs(solid.closest(p).distance) + 0.02, leaves)) continue;
    ++found;
    const Vec3 q = p + points.in_box(Vec3::Constant(0.01));
    QueryMemory memory;
    EXPECT_EQ(solid.distance_among(q, leaves), solid.closest(q, memory).distance) << q.transpose();
  }
  EXPECT_GT(found, 1000);
  NearLeaves leaves;
  EXPECT_FALSE(solid.find_leaves(Vec3::Zero(), 2, leaves));
}

TEST(TriangleSolid, AWayEntersWhereTheDistanceFirstVanishes) {
  for (const TriMesh& mesh : {test::torus_surface(1, 0.4, 60, 30), test::box_surface(Vec3(1, 0.5, 0.25))}) {
    const TriangleSolid solid(mesh);
    Points points(9);
    int met = 0;
    for (int i = 0; i < 20'000; ++i) {
      // Every third way runs along an axis, through vertices and edges.
      const Vec3 a =
          i % 3 ? points.in_box(Vec3::Constant(2)) : Vec3(2, 0.25 * (i / 3 % 17 - 8), 0.25 * (i / 51 % 17 - 8));
      const Vec3 b = i % 3 ? points.in_box(Vec3::Constant(2)) : Vec3(-2, a.y(), a.z());
      if (solid.closest(a).distance < 1e-6) continue;
      const std::optional<double> share = solid.entry(a, b);
      // The plain version steps as far as the distance allows.
      const double length = (b - a).norm();
      double gone = 0, field = solid.closest(a).distance;
      for (int march = 0; march < 2000 && field > 1e-7 && gone < length; ++march) {
        gone += field;
        field = solid.closest(a + std::min(1.0, gone / length) * (b - a)).distance;
      }
      if (gone < length) {
        // A way that grazes the surface nearly meets it for long before it does, or only nearly meets it at all.
        if (!share) {
          EXPECT_GT(solid.closest(a + gone / length * (b - a)).distance, -1e-9) << i;
          continue;
        }
        EXPECT_GT(*share * length, gone - 1e-6) << i;
        EXPECT_LT(std::abs(solid.closest(a + *share * (b - a)).distance), 1e-9) << i;
        ++met;
      } else {
        EXPECT_FALSE(share.has_value() && *share < 1 - 1e-6) << i;
      }
    }
    EXPECT_GT(met, 2000);
  }
}

}  // namespace triangle_solid_test
}  // namespace supple
