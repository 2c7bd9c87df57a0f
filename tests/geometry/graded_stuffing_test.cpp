// Tests lattices whose elements are smaller in some places, and bodies whose thin parts they hold.
#include <gtest/gtest.h>

#include <map>

#include "base/error.h"
#include "geometry/tetrahedra/bisected_lattice.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"
#include "scene/reading/shape_reader.h"

namespace supple {
namespace graded_stuffing_test {

TetMesh mesh_of(const BisectedLattice& lattice) {
  TetMesh mesh;
  mesh.rest.resize(Eigen::Index(lattice.sites.size()), 3);
  for (std::size_t s = 0; s < lattice.sites.size(); ++s)
    mesh.rest.row(Eigen::Index(s)) = lattice.sites[s].cast<double>().transpose();
  mesh.tets.resize(Eigen::Index(lattice.tets.size()), 4);
  for (std::size_t t = 0; t < lattice.tets.size(); ++t) {
    for (int k = 0; k < 4; ++k) mesh.tets(Eigen::Index(t), k) = lattice.tets[t][std::size_t(k)];
    if (tet_volume(mesh, Eigen::Index(t)) < 0) std::swap(mesh.tets(Eigen::Index(t), 2), mesh.tets(Eigen::Index(t), 3));
  }
  return mesh;
}

bool everywhere(const Vec3&, double) { return true; }
bool nowhere(const Vec3&, double) { return false; }

// Counts edges of each squared length of the elements whose sites all lie inside the box that is `margin` smaller.
std::map<int, int> edges_inside(const BisectedLattice& lattice, int size, int margin) {
  std::map<int, int> edges;
  for (const auto& tet : lattice.tets) {
    bool inside = true;
    for (const int s : tet) {
      const Eigen::Vector3i& site = lattice.sites[std::size_t(s)];
      inside &= site.minCoeff() >= margin && site.maxCoeff() <= size - margin;
    }
    if (!inside) continue;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        ++edges[(lattice.sites[std::size_t(tet[i])] - lattice.sites[std::size_t(tet[j])]).squaredNorm()];
  }
  return edges;
}

TEST(BisectedLattice, IsBodyCentredCubicWhereNothingIsTooLarge) {
  const BisectedLattice lattice = bisected_lattice({3, 4, 5}, 1, everywhere, nowhere);
  const MeshQuality made = quality(mesh_of(lattice));
  EXPECT_NEAR(made.volume, 12 * 16 * 20, 1e-6);
  EXPECT_NEAR(made.smallest_volume, 1, 1e-9);
  // Two long edges and four short ones, of 1 and the half of the square root of 3 cells.
  const BisectedLattice cube = bisected_lattice({4, 4, 4}, 1, everywhere, nowhere);
  const std::map<int, int> edges = edges_inside(cube, 16, 4);
  ASSERT_EQ(edges.size(), 2u);
  EXPECT_EQ(edges.begin()->first, 12);
  EXPECT_EQ(edges.rbegin()->first, 16);
  EXPECT_EQ(edges.at(12), 2 * edges.at(16));
}

TEST(BisectedLattice, IsTheSameLatticeTwiceAsFineWhereEverythingIsTooLarge) {
  const auto too_large = [](const Vec3&, double spacing) { return spacing > 2.1; };
  const std::map<int, int> edges = edges_inside(bisected_lattice({3, 3, 3}, 1, everywhere, too_large), 12, 2);
  ASSERT_EQ(edges.size(), 2u);
  EXPECT_EQ(edges.begin()->first, 3);
  EXPECT_EQ(edges.rbegin()->first, 4);
}

// Elements of two sizes that did not match would leave faces inside that belong to one element alone.
TEST(BisectedLattice, FitsTogetherBetweenTwoSizesWithGoodAngles) {
  const Vec3 place(13, 9, 11);
  for (const int halvings : {1, 2, 3}) {
    const double finest = 2, unit = 2 << halvings;
    const auto too_large = [&](const Vec3& middle, double spacing) {
      return spacing > 1.01 * finest && (middle - place * unit / 4).norm() < 0.7 * unit;
    };
    const TetMesh mesh = mesh_of(bisected_lattice({6, 6, 6}, halvings, everywhere, too_large));
    const MeshQuality made = quality(mesh);
    EXPECT_NEAR(made.volume / std::pow(6 * unit, 3), 1, 1e-9) << halvings;
    EXPECT_GT(made.smallest_dihedral, 44.99) << halvings;
    EXPECT_LT(made.largest_dihedral, 120.01) << halvings;
    EXPECT_NEAR(made.smallest_volume * made.volume / double(mesh.tets.rows()), std::pow(finest, 3) / 12, 1e-9);
    const Triangles boundary = boundary_faces(mesh.tets);
    for (Eigen::Index f = 0; f < boundary.rows(); ++f) {
      bool on_the_box = false;
      for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {0.0, 6 * unit}) {
          bool all = true;
          for (int k = 0; k < 3; ++k) all &= mesh.rest(boundary(f, k), axis) == side;
          on_the_box |= all;
        }
      }
      ASSERT_TRUE(on_the_box) << halvings << ": face " << f;
    }
  }
}

// A ball with a thin rod, as a surface that somebody else made.
TriMesh lollipop(double rod_radius) {
  Shape shape;
  shape.root.parts.emplace_back().primitive = Sphere{0.5};
  shape.root.parts.emplace_back().primitive = Capsule{Vec3::Zero(), Vec3(1.3, 0.2, 0.3), rod_radius};
  const TetMesh fine = tetrahedralize(shape, 30000, "lollipop");
  return {fine.rest, boundary_faces(fine.tets)};
}

double held_length(const TetMesh& mesh) {
  const Vec3 way = Vec3(1.3, 0.2, 0.3);
  double length = 0;
  Positions points(200, 3);
  for (int i = 0; i < 200; ++i) points.row(i) = (i / 200.0 * way).transpose();
  for (const char inside : inside_elements(mesh, points)) length += inside / 200.0;
  return length;
}

TEST(GradedStuffing, HoldsARodThatAUniformLatticeLosesAndStaysSlim) {
  for (const double radius : {0.05, 0.035}) {
    const TriMesh surface = lollipop(radius);
    const Shape shape = shape_of(surface);
    const std::vector<ThicknessSample> thickness = sampled_thickness(surface, 4000);
    const TetMesh uniform = tetrahedralize(shape, 700, "rod");
    EXPECT_LT(held_length(uniform), 0.6) << radius;
    const TetMesh mesh = graded_tetrahedralize(shape, 700, "rod", thickness, 1.5);
    EXPECT_NEAR(double(mesh.rest.rows()), 700, 70);
    EXPECT_GT(held_length(mesh), 0.98) << radius;
    const Manifoldness found = manifoldness(mesh);
    EXPECT_EQ(found.pieces, 1);
    EXPECT_EQ(found.bad_edges, 0);
    EXPECT_EQ(found.bad_vertices, 0);
    const MeshQuality made = quality(mesh);
    EXPECT_GT(made.smallest_dihedral, 4) << radius;
    EXPECT_GT(made.smallest_volume, 1e-4) << radius;
    // The ball keeps its size, and the rod swells by a fraction of an element.
    EXPECT_NEAR(made.volume, quality(uniform).volume, 0.12 * made.volume) << radius;
    EXPECT_NEAR(bounds_of(mesh.rest).lower.x(), -0.5, 0.02) << radius;
  }
}

TEST(GradedStuffing, IsTheUniformLatticeWhereNothingIsThin) {
  Shape ball;
  ball.root.parts.emplace_back().primitive = Sphere{1};
  const TetMesh fine = tetrahedralize(ball, 20000, "ball");
  const TriMesh surface{fine.rest, boundary_faces(fine.tets)};
  const TetMesh mesh = graded_tetrahedralize(shape_of(surface), 1500, "ball", sampled_thickness(surface), 1.5);
  EXPECT_NEAR(double(mesh.rest.rows()), 1500, 150);
  EXPECT_NEAR(quality(mesh).volume / (4.0 / 3 * M_PI), 1, 0.02);
  EXPECT_GT(quality(mesh).smallest_dihedral, 8);
  // Elements away from the surface are all equal.
  double smallest = 1e9, largest = 0;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    double furthest = 0;
    for (int k = 0; k < 4; ++k) furthest = std::max(furthest, mesh.rest.row(mesh.tets(e, k)).norm());
    if (furthest > 0.7) continue;
    smallest = std::min(smallest, tet_volume(mesh, e));
    largest = std::max(largest, tet_volume(mesh, e));
  }
  EXPECT_GT(largest, 0);
  EXPECT_NEAR(smallest / largest, 1, 1e-6);
}

// None of the samples of the volume meets the bar.
TEST(GradedStuffing, RefusesWhatIsTooSlenderForItsSamples) {
  const TriMesh bar = lollipop(0.05);
  Shape shape;
  shape.root.parts.emplace_back().primitive = Capsule{Vec3(-1, -1, -1), Vec3(1, 1, 1.1), 1e-4};
  EXPECT_THROW(graded_tetrahedralize(shape, 500, "hair", sampled_thickness(bar), 1.5), InputError);
}

}  // namespace graded_stuffing_test
}  // namespace supple
