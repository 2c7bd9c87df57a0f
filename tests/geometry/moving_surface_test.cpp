// Tests closest places, entries and boxes of a moving surface against brute force, sides by the winding number.
#include "geometry/triangles/moving_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include "geometry/triangles/triangle_soup.h"
#include "support/surfaces.h"

namespace supple {
namespace moving_surface_test {

class Numbers {
 public:
  explicit Numbers(unsigned seed) : random_(seed) {}
  double share() { return 0.5 + 0.5 * uniform_(random_); }
  Vec3 in_cube(double half) { return half * Vec3(uniform_(random_), uniform_(random_), uniform_(random_)); }
  std::int32_t below(Eigen::Index count) { return std::int32_t(random_() % std::uint64_t(count)); }

 private:
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

Positions shaken(Positions x, double amount, Numbers& numbers) {
  for (auto row : x.rowwise()) row += numbers.in_cube(amount).transpose();
  return x;
}

// Follows van Oosterom and Strackee, The solid angle of a plane triangle, 1983.
bool is_inside(const Triangles& triangles, const Positions& x, const Vec3& p) {
  double angle = 0;
  for (const auto& t : triangles.rowwise()) {
    const Vec3 a = x.row(t[0]).transpose() - p, b = x.row(t[1]).transpose() - p, c = x.row(t[2]).transpose() - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle > 2 * std::numbers::pi;
}

double distance_by_brute_force(const Triangles& triangles, const Positions& x, const Vec3& p) {
  double least = infinity;
  for (const auto& t : triangles.rowwise())
    least = std::min(least, (closest_in_triangle(p, x.row(t[0]), x.row(t[1]), x.row(t[2])) - p).norm());
  return least;
}

// Holds a surface, the places of its vertices, and what was asked of it.
struct Motion {
  TriMesh rest;
  Positions start, end;
  MovingSurface surface;

  Motion(const TriMesh& mesh, const Positions& from, const Positions& to)
      : rest(mesh), start(from), end(to), surface(mesh.triangles, mesh.points) {
    surface.set_start(start);
    surface.set_end(end);
  }
  Positions at(double share) const { return (1 - share) * start + share * end; }
  bool is_inside(const Vec3& a, const Vec3& b, double share) const {
    return moving_surface_test::is_inside(rest.triangles, at(share), (1 - share) * a + share * b);
  }
};

// Makes a dented ball that grows and turns while it moves.
Motion dented_ball(Numbers& numbers, const Vec3& way) {
  const TriMesh mesh = test::sphere_surface(1, 10, 6);
  const Positions start = shaken(mesh.points, 0.06, numbers);
  const Mat3 turn = 1.2 * Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  Positions end = shaken(start, 0.06, numbers) * turn.transpose();
  end.rowwise() += way.transpose();
  return {mesh, start, end};
}

void check_place(const Motion& motion, const Positions& x, const Vec3& p, const MovingSurface::Place& place) {
  EXPECT_NEAR(std::abs(place.distance), distance_by_brute_force(motion.rest.triangles, x, p), 1e-14);
  EXPECT_EQ(place.distance < 0, is_inside(motion.rest.triangles, x, p)) << p.transpose();
  EXPECT_NEAR(place.normal.norm(), 1, 1e-14);
  EXPECT_GE(place.weights.minCoeff(), 0);
  EXPECT_NEAR(place.weights.sum(), 1, 1e-15);
  Vec3 point = Vec3::Zero();
  for (int k = 0; k < 3; ++k) point += place.weights[k] * x.row(motion.rest.triangles(place.triangle, k)).transpose();
  EXPECT_NEAR((point - place.point).norm(), 0, 1e-14);
  EXPECT_NEAR((place.point + place.distance * place.normal - p).norm(), 0, 1e-12);
}

TEST(MovingSurface, FindsThePlaceAndTheSideThatBruteForceFindsAtBothTimes) {
  Numbers numbers(1);
  for (const TriMesh& mesh : {test::sphere_surface(1, 20, 10), test::torus_surface(1, 0.4, 25, 11)}) {
    const Positions start = shaken(mesh.points, 0.02, numbers), end = shaken(2 * start, 0.03, numbers);
    const Motion motion(mesh, start, end);
    int inside = 0;
    for (int i = 0; i < 1500; ++i) {
      const Vec3 p = numbers.in_cube(1.6);
      const auto at_start = motion.surface.closest_at_start(p, infinity);
      const auto at_end = motion.surface.closest_at_end(p, infinity);
      ASSERT_TRUE(at_start && at_end);
      check_place(motion, start, p, *at_start);
      check_place(motion, end, p, *at_end);
      inside += at_start->distance < 0;
      const double from = std::abs(at_start->distance);
      EXPECT_TRUE(motion.surface.closest_at_start(p, 1.001 * from).has_value());
      EXPECT_FALSE(motion.surface.closest_at_start(p, 0.999 * from).has_value());
    }
    EXPECT_GT(inside, 100);
  }
}

TEST(MovingSurface, AnyTrianglesDistanceIsABoundThatChangesNoPlace) {
  Numbers numbers(7);
  const TriMesh mesh = test::torus_surface(1, 0.4, 25, 11);
  const Positions start = shaken(mesh.points, 0.02, numbers), end = shaken(2 * start, 0.03, numbers);
  const Motion motion(mesh, start, end);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = numbers.in_cube(2.6);
    const MovingSurface::Place place = *motion.surface.closest_at_end(p, infinity);
    EXPECT_NEAR(motion.surface.distance_at_end(place.triangle, p), std::abs(place.distance), 1e-12);
    for (const std::int32_t t : {place.triangle, std::int32_t(i % mesh.triangles.rows())}) {
      const double bound = motion.surface.distance_at_end(t, p);
      EXPECT_GE(bound, std::abs(place.distance) - 1e-12);
      const auto bounded = motion.surface.closest_at_end(p, (1 + 1e-9) * bound);
      ASSERT_TRUE(bounded.has_value());
      EXPECT_EQ(bounded->triangle, place.triangle);
      EXPECT_EQ(bounded->weights, place.weights);
      EXPECT_EQ(bounded->distance, place.distance);
    }
  }
}

TEST(MovingSurface, TheNormalIsTheGradientOfTheDistance) {
  Numbers numbers(2);
  const Motion motion = dented_ball(numbers, Vec3(0.5, 0, 0));
  const double h = 1e-6;
  int smooth = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = numbers.in_cube(1.3);
    const MovingSurface::Place place = *motion.surface.closest_at_start(p, infinity);
    Vec3 gradient;
    for (int k = 0; k < 3; ++k) {
      const Vec3 step = h * Vec3::Unit(k);
      gradient[k] = (motion.surface.closest_at_start(p + step, infinity)->distance -
                     motion.surface.closest_at_start(p - step, infinity)->distance) /
                    (2 * h);
    }
    // Where two places are equally near, the distance has no gradient; differences across there are short.
    if (gradient.norm() < 1 - 1e-6) continue;
    ++smooth;
    EXPECT_NEAR((gradient - place.normal).norm(), 0, 1e-4) << p.transpose();
  }
  EXPECT_GT(smooth, 1900);
}

TEST(MovingSurface, OnTheSurfaceTheNormalIsThePseudonormal) {
  const Vec3 half(1, 2, 3);
  const TriMesh mesh = test::box_surface(half);
  const MovingSurface box(mesh.triangles, mesh.points);
  const auto normal_at = [&](const Vec3& p) { return box.closest_at_start(p, 1e-9)->normal; };
  // Some corners have one triangle in a side, others two.
  for (const auto& vertex : mesh.points.rowwise()) {
    const Vec3 corner = vertex.transpose();
    EXPECT_NEAR((normal_at(corner) - corner.cwiseSign().normalized()).norm(), 0, 1e-14);
  }
  EXPECT_NEAR((normal_at(Vec3(1, -2, 0.3)) - Vec3(1, -1, 0).normalized()).norm(), 0, 1e-14);
  EXPECT_NEAR((normal_at(Vec3(0.2, 0.3, -3)) - Vec3(0, 0, -1)).norm(), 0, 1e-14);
}

TEST(MovingSurface, TrianglesWithoutAreaAndOpenEdgesMakeNoNumbersThatAreNone) {
  TriMesh mesh = test::box_surface(Vec3(1, 1, 1));
  mesh.triangles.conservativeResize(15, 3);
  mesh.triangles.bottomRows(3) << 0, 0, 1, 5, 5, 5, 0, 4, 6;  // the last one repeats the first
  Positions flat = mesh.points;
  flat.col(1).setZero();
  flat.row(3) = flat.row(1);
  Numbers numbers(3);
  for (const Positions& x : {mesh.points, flat, Positions(0 * flat)}) {
    const Motion motion(mesh, x, mesh.points);
    for (int i = 0; i < 300; ++i) {
      const Vec3 p = i % 3 ? numbers.in_cube(2) : Vec3(x.row(i % 8)), q = numbers.in_cube(2);
      const MovingSurface::Place place = *motion.surface.closest_at_start(p, infinity);
      EXPECT_TRUE(std::isfinite(place.distance) && place.weights.allFinite() && place.point.allFinite());
      EXPECT_NEAR(place.normal.norm(), 1, 1e-14);
      const auto entry = motion.surface.first_entry(p, q, Vec3::Zero());
      EXPECT_TRUE(!entry || (entry->weights.allFinite() && entry->normal.allFinite()));
    }
  }
}

// Times shortly before and after an entry decide whether it is one; those in between, whether an earlier one is missed.
void check_entry(const Motion& motion, const Vec3& a, const Vec3& b, int& entries) {
  constexpr int samples = 100;
  const auto entry = motion.surface.first_entry(a, b, motion.end.colwise().mean().transpose());
  if (entry) {
    ++entries;
    if (entry->share > 1e-6 && entry->share < 1 - 1e-6) {
      EXPECT_FALSE(motion.is_inside(a, b, entry->share - 1e-6));
      EXPECT_TRUE(motion.is_inside(a, b, entry->share + 1e-6));
    }
    const Positions x = motion.at(entry->share);
    Vec3 point = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      point += entry->weights[k] * x.row(motion.rest.triangles(entry->triangle, k)).transpose();
    EXPECT_NEAR((point - (1 - entry->share) * a - entry->share * b).norm(), 0, 1e-6);
    const auto corner = [&](int k) -> Vec3 { return x.row(motion.rest.triangles(entry->triangle, k)); };
    const Vec3 area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    EXPECT_NEAR((area.normalized() - entry->normal).norm(), 0, 1e-12);
  }
  bool was_inside = motion.is_inside(a, b, 0);
  for (int i = 1; i <= samples; ++i) {
    const double share = double(i) / samples;
    const bool inside = motion.is_inside(a, b, share);
    if (inside && !was_inside) {
      EXPECT_TRUE(entry && entry->share <= share) << share;
      return;
    }
    was_inside = inside;
  }
}

TEST(MovingSurface, FindsTheFirstEntryThatDenseTimesFind) {
  Numbers numbers(4);
  int entries = 0;
  for (int i = 0; i < 6; ++i) {
    const Motion motion = dented_ball(numbers, numbers.in_cube(3));
    const Vec3 middle = motion.end.colwise().mean();
    for (int k = 0; k < 60; ++k) check_entry(motion, numbers.in_cube(2), middle + numbers.in_cube(2), entries);
  }
  EXPECT_GT(entries, 100);
}

// Beyond the last exit a line is outside, and right before it inside, whatever the surface does until the end.
TEST(MovingSurface, FindsTheLastExitOfALineThroughTheStart) {
  Numbers numbers(14);
  int exits = 0;
  for (int i = 0; i < 6; ++i) {
    const Motion motion = dented_ball(numbers, numbers.in_cube(3));
    for (int k = 0; k < 60; ++k) {
      const Vec3 a = numbers.in_cube(1.5), b = numbers.in_cube(1.5);
      const auto at = [&](double share) -> Vec3 { return (1 - share) * a + share * b; };
      const auto inside = [&](double share) { return is_inside(motion.rest.triangles, motion.start, at(share)); };
      const auto exit = motion.surface.last_exit_at_start(a, b);
      if (!exit) {
        EXPECT_TRUE(!inside(0) || inside(1));
        continue;
      }
      ++exits;
      EXPECT_TRUE(inside(exit->share - 1e-9));
      Vec3 place = Vec3::Zero();
      for (int c = 0; c < 3; ++c)
        place += exit->weights[c] * motion.start.row(motion.rest.triangles(exit->triangle, c)).transpose();
      EXPECT_NEAR((place - at(exit->share)).norm(), 0, 1e-9);
      EXPECT_GT(exit->normal.dot(b - a), 0);
      constexpr int samples = 50;
      for (int s = 1; s <= samples && !inside(1); ++s)
        EXPECT_FALSE(inside(exit->share + (1 - exit->share) * s / samples));
    }
  }
  EXPECT_GT(exits, 60);
}

TEST(MovingSurface, APointThatEndsInsideHasEnteredOrWasInsideAllTheTime) {
  Numbers numbers(5);
  int checked = 0;
  for (int i = 0; i < 20; ++i) {
    const Motion motion = dented_ball(numbers, numbers.in_cube(5));
    const Vec3 middle = motion.end.colwise().mean();
    for (int k = 0; k < 1000; ++k) {
      const Vec3 a = numbers.in_cube(3), b = middle + numbers.in_cube(1.2);
      if (motion.surface.closest_at_start(a, infinity)->distance < 0) continue;
      if (motion.surface.closest_at_end(b, infinity)->distance > 0) continue;
      ++checked;
      EXPECT_TRUE(motion.surface.first_entry(a, b, middle).has_value());
    }
  }
  EXPECT_GT(checked, 5000);
}

// The point is aimed at places that two or more triangles share at that time, from all sides that lead inside.
TEST(MovingSurface, NothingSlipsThroughAnEdgeOrAVertex) {
  Numbers numbers(6);
  int checked = 0;
  for (int i = 0; i < 4; ++i) {
    const Motion motion = dented_ball(numbers, i == 0 ? Vec3(Vec3::Zero()) : numbers.in_cube(2));
    for (int k = 0; k < 400; ++k) {
      const double share = i % 2 ? 0.1 + 0.8 * numbers.share() : 0.5, s = k % 2 ? 0 : numbers.share();
      const auto t = numbers.below(motion.rest.triangles.rows());
      const auto on_edge = [&](const Positions& x) -> Vec3 {
        return (1 - s) * x.row(motion.rest.triangles(t, 0)) + s * x.row(motion.rest.triangles(t, 1));
      };
      const Vec3 aim = on_edge(motion.at(share)), carried = on_edge(motion.end) - on_edge(motion.start);
      const Vec3 way = numbers.in_cube(0.4);
      const Vec3 a = aim - share * (carried + way), b = aim + (1 - share) * (carried + way);
      if (motion.is_inside(a, b, 0) || !motion.is_inside(a, b, 1)) continue;
      ++checked;
      EXPECT_TRUE(motion.surface.first_entry(a, b, carried).has_value()) << i << " " << k << " " << s;
    }
  }
  EXPECT_GT(checked, 300);
}

TEST(MovingSurface, APointOnTheSurfaceEntersAtOnceWhereItMovesInward) {
  Numbers numbers(7);
  const Motion motion = dented_ball(numbers, Vec3::Zero());
  MovingSurface still(motion.rest.triangles, motion.start);
  for (int i = 0; i < 2000; ++i) {
    const auto t = numbers.below(motion.rest.triangles.rows());
    const auto corner = [&](int k) -> Vec3 { return motion.start.row(motion.rest.triangles(t, k)); };
    const Vec3 p = i % 3 == 0   ? corner(0)
                   : i % 3 == 1 ? Vec3(0.25 * corner(0) + 0.75 * corner(1))
                                : Vec3(0.2 * corner(0) + 0.3 * corner(1) + 0.5 * corner(2));
    const auto inward = still.first_entry(p, 0.9 * p, Vec3::Zero());
    ASSERT_TRUE(inward.has_value()) << i;
    EXPECT_LT(inward->share, 1e-14);
    EXPECT_FALSE(still.first_entry(p, 1.5 * p, Vec3::Zero()).has_value());
    EXPECT_FALSE(still.first_entry(2 * p, p + 1e-9 * p, Vec3::Zero()).has_value());
  }
}

// Ways between the points of a grid run through corners, along edges and within the planes of faces.
TEST(MovingSurface, WaysOnTheGridOfTheVerticesEnterWhereTheFormulaSays) {
  const TriMesh mesh = test::box_surface(Vec3(1, 1, 1));
  MovingSurface box(mesh.triangles, mesh.points);
  const Vec3 way(0.25, -4, 1.5);
  box.set_end(test::moved(mesh, way).points);
  for (int i = 0; i < 9 * 9 * 9; ++i) {
    const Vec3 a = 0.5 * Vec3(i % 9 - 4, i / 9 % 9 - 4, i / 81 - 4);
    if (a.cwiseAbs().maxCoeff() < 1) continue;
    for (int j = 0; j < 27; ++j) {
      const Vec3 b = 0.5 * Vec3(j % 3 - 1, j / 3 % 3 - 1, j / 9 - 1);
      double expected = 0;  // the last of the times at which the point comes between two opposite sides
      for (int k = 0; k < 3; ++k)
        if (std::abs(a[k]) > 1) expected = std::max(expected, (std::abs(a[k]) - 1) / std::abs(b[k] - a[k]));
      const auto entry = box.first_entry(a, b + way, j % 2 ? way : Vec3(Vec3::Zero()));
      ASSERT_TRUE(entry.has_value()) << a.transpose() << " to " << b.transpose();
      EXPECT_NEAR(entry->share, expected, 1e-12) << a.transpose() << " to " << b.transpose();
    }
  }
}

TEST(MovingSurface, LooksNoFurtherThanTheLatestShare) {
  const TriMesh mesh = test::box_surface(Vec3(1, 1, 1));
  const MovingSurface box(mesh.triangles, mesh.points);
  const Vec3 a(0.1, 3, 0.3), b(0.1, -1, 0.3);
  EXPECT_NEAR(box.first_entry(a, b, Vec3::Zero())->share, 0.5, 1e-15);
  EXPECT_TRUE(box.first_entry(a, b, Vec3::Zero(), 0.51).has_value());
  EXPECT_FALSE(box.first_entry(a, b, Vec3::Zero(), 0.49).has_value());
}

TEST(MovingSurface, AMotionInWhichAllTakePartChangesNoEntry) {
  Numbers numbers(8);
  const Motion slow = dented_ball(numbers, Vec3::Zero());
  const Vec3 common(300, -200, 150);
  Positions far = slow.end;
  far.rowwise() += common.transpose();
  const Motion fast(slow.rest, slow.start, far);
  int entries = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 a = numbers.in_cube(1.5), b = numbers.in_cube(1.5);
    const auto expected = slow.surface.first_entry(a, b, Vec3::Zero());
    for (const Vec3& carried : {common, Vec3(Vec3::Zero()), Vec3(0.5 * common)}) {
      const auto found = fast.surface.first_entry(a, b + common, carried);
      ASSERT_EQ(found.has_value(), expected.has_value()) << i;
      if (!found) continue;
      ++entries;
      EXPECT_EQ(found->triangle, expected->triangle);
      EXPECT_NEAR(found->share, expected->share, 1e-9);
      EXPECT_NEAR((found->weights - expected->weights).norm(), 0, 1e-9);
      EXPECT_NEAR((found->normal - expected->normal).norm(), 0, 1e-9);
    }
  }
  EXPECT_GT(entries, 1000);
}

// Returns how near each vertex of the other surface comes to this one at a few times.
std::vector<double> nearest_by_brute_force(const Motion& one, const Motion& other) {
  std::vector<double> nearest(std::size_t(other.start.rows()), infinity);
  for (const double share : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
    const Positions x = one.at(share), y = other.at(share);
    for (std::size_t v = 0; v < nearest.size(); ++v)
      nearest[v] =
          std::min(nearest[v], distance_by_brute_force(one.rest.triangles, x, y.row(Eigen::Index(v)).transpose()));
  }
  return nearest;
}

TEST(MovingSurface, MissesNoVertexThatComesNear) {
  Numbers numbers(9);
  const double margin = 0.05;
  int meetings = 0, apart = 0;
  std::size_t near = 0, found_near = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 carried = i % 2 ? numbers.in_cube(50) : Vec3(Vec3::Zero());
    const Motion one = dented_ball(numbers, carried);
    Motion other = dented_ball(numbers, carried + numbers.in_cube(1));
    const Vec3 aside = (1.5 + 2 * numbers.share()) * numbers.in_cube(1).normalized();
    other.start.rowwise() += aside.transpose();
    other.end.rowwise() += aside.transpose();
    other.surface.set_start(other.start);
    other.surface.set_end(other.end);
    const std::vector<double> nearest = nearest_by_brute_force(one, other);
    const bool may_meet = one.surface.may_meet(other.surface, margin, carried);
    for (std::int32_t v = 0; v < std::ssize(nearest); ++v) {
      const bool is_found = one.surface.is_near(other.start.row(v), other.end.row(v), carried, margin);
      found_near += is_found;
      if (nearest[std::size_t(v)] >= margin) continue;
      ++near;
      EXPECT_TRUE(may_meet && is_found) << i << " " << v;
    }
    meetings += may_meet;
    apart += !may_meet;
  }
  EXPECT_GT(meetings, 5);
  EXPECT_GT(apart, 5);
  EXPECT_GT(near, 50u);
  EXPECT_LT(found_near, 1000u);  // of 2080
}

// Pairs are left out only where boxes are apart, or where all that two leaves hold faces one way.
TEST(MovingSurface, PairsItselfWhereItComesNear) {
  Numbers numbers(11);
  const Vec3 carried(4, 5, 6);
  const Motion motion = dented_ball(numbers, carried);
  const double margin = 0.4;
  MovingSurface::SolidParts none = motion.surface.solid_parts([](std::int32_t, std::vector<std::int32_t>&) {});
  std::set<std::pair<std::int32_t, std::int32_t>> found;
  motion.surface.any_own_pair(none, motion.start, motion.end, margin, carried, 2, [&](std::int32_t v, std::int32_t t) {
    EXPECT_TRUE(found.emplace(v, t).second) << "twice";
    return false;
  });
  std::size_t near = 0, paired = 0;
  for (std::int32_t v = 0; v < motion.start.rows(); ++v) {
    for (std::int32_t t = 0; t < motion.rest.triangles.rows(); ++t) {
      const auto corners = motion.rest.triangles.row(t);
      double least = infinity;
      for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const Positions x = motion.at(share);
        const Vec3 p = x.row(v);
        least = std::min(least,
                         (closest_in_triangle(p, x.row(corners[0]), x.row(corners[1]), x.row(corners[2])) - p).norm());
      }
      if (least > margin || (corners.array() == v).any()) continue;
      ++near;
      paired += found.contains({v, t});
    }
  }
  EXPECT_GT(near, 100u);
  EXPECT_GT(double(paired), 0.7 * double(near)) << "those of one leaf are not paired";
  EXPECT_LT(double(found.size()), 0.8 * double(motion.start.rows() * motion.rest.triangles.rows()));
  EXPECT_FALSE(motion.surface.any_own_pair(none, motion.start, motion.end, margin, carried, -2,
                                           [](std::int32_t, std::int32_t) { return true; }))
      << "all cosines are above -2";
  int calls = 0;
  EXPECT_TRUE(motion.surface.any_own_pair(none, motion.start, motion.end, margin, carried, 2,
                                          [&](std::int32_t, std::int32_t) { return ++calls == 3; }));
  EXPECT_EQ(calls, 3);
}

TEST(MovingSurface, PairsItselfWithoutPairsThatAreLeftOut) {
  Numbers numbers(11);
  const Vec3 carried(4, 5, 6);
  const Motion motion = dented_ball(numbers, carried);
  using Pairs = std::set<std::pair<std::int32_t, std::int32_t>>;
  const auto is_left_out = [](std::int32_t v, std::int32_t t) { return (3 * v + 5 * t) % 7 < 3; };
  const auto pairs_without = [&](const MovingSurface::TrianglesOf& triangles_of) {
    Pairs found;
    MovingSurface::SolidParts parts = motion.surface.solid_parts(triangles_of);
    motion.surface.any_own_pair(parts, motion.start, motion.end, 0.4, carried, 0.5,
                                [&](std::int32_t v, std::int32_t t) { return found.emplace(v, t), false; });
    return found;
  };
  Pairs kept = pairs_without([](std::int32_t, std::vector<std::int32_t>&) {});
  const std::size_t all = kept.size();
  std::erase_if(kept, [&](const auto& pair) { return is_left_out(pair.first, pair.second); });
  EXPECT_EQ(pairs_without([&](std::int32_t v, std::vector<std::int32_t>& triangles) {
              for (std::int32_t t = 0; t < motion.rest.triangles.rows(); ++t)
                if (is_left_out(v, t)) triangles.insert(triangles.begin(), 2, t);
            }),
            kept);
  EXPECT_GT(kept.size(), 100u);
  EXPECT_LT(kept.size(), all);
}

// Leaves with fewer than four triangles, triangles that have all their vertices to themselves, and a tree of one leaf.
TEST(MovingSurface, PairsItselfWithoutPairsThatAreLeftOutInOddLeaves) {
  for (const int count : {1, 3, 4, 5, 11, 18}) {
    Triangles triangles(count, 3);
    Positions x(3 * count, 3);
    Numbers numbers(count);
    for (int t = 0; t < count; ++t) {
      triangles.row(t) << 3 * t, 3 * t + 1, 3 * t + 2;
      for (int k = 0; k < 3; ++k) x.row(3 * t + k) = numbers.in_cube(1).transpose();
    }
    const MovingSurface surface(triangles, x);
    const auto find = [&](const MovingSurface::TrianglesOf& triangles_of) {
      MovingSurface::SolidParts parts = surface.solid_parts(triangles_of);
      std::set<std::pair<std::int32_t, std::int32_t>> found;
      surface.any_own_pair(parts, x, x, 10, Vec3::Zero(), 2,
                           [&](std::int32_t v, std::int32_t t) { return found.emplace(v, t), false; });
      return found;
    };
    auto kept = find([](std::int32_t, std::vector<std::int32_t>&) {});
    EXPECT_EQ(kept.empty(), count <= 4) << count;
    std::erase_if(kept, [&](const auto& pair) { return (pair.first + pair.second) % 3 == 0; });
    EXPECT_EQ(find([&](std::int32_t v, std::vector<std::int32_t>& left_out) {
                for (std::int32_t t = 0; t < count; ++t)
                  if ((v + t) % 3 == 0) left_out.push_back(t);
              }),
              kept)
        << count;
  }
}

TEST(MovingSurface, HasTheBoxesOfItsVertices) {
  Numbers numbers(10);
  const Motion motion = dented_ball(numbers, Vec3(1, 2, 3));
  EXPECT_EQ(motion.surface.bounds_at_start().lower, bounds_of(motion.start).lower);
  EXPECT_EQ(motion.surface.bounds_at_start().upper, bounds_of(motion.start).upper);
  EXPECT_EQ(motion.surface.bounds_at_end().lower, bounds_of(motion.end).lower);
  EXPECT_EQ(motion.surface.bounds_at_end().upper, bounds_of(motion.end).upper);
}

}  // namespace moving_surface_test
}  // namespace supple
