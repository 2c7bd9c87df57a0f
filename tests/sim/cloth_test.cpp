// Tests triangles of cloth and their bending: second derivatives against differences, closed forms of sheets that are
// stretched, bent and hung, and what no frame of reference may change.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/variants.h"
#include "geometry/meshes/cloth.h"
#include "sim/elements/element_kernels.h"
#include "sim/elements/triangle_stiffness.h"
#include "sim/linear/linear_kernels.h"
#include "sim/model/bending.h"
#include "sim/solver/begin_step.h"
#include "sim/solver/hessian_matrix.h"
#include "sim/solver/objective.h"
#include "support/bodies.h"
#include "support/deformations.h"
#include "support/objective_checks.h"

namespace supple {
namespace cloth_test {

constexpr int inner = 6;  // coordinates of corners 1 and 2

struct OneTriangle {
  double field[Triangle::fields];
  Eigen::Matrix<double, 3, 3> rest;  // corners as columns

  OneTriangle() {
    Triangle::fill({0.9, 0.2, 0.1, 1.1}, field);
    rest << 0, 0.9, 0.2, 0, 0.1, 1.1, 0, 0, 0;
  }
};

using Six = Eigen::Matrix<double, inner, 1>;
using SixBySix = Eigen::Matrix<double, inner, inner>;

Six slope_at(const Membrane& membrane, const OneTriangle& one, const Mat3& corners) {
  double x[3][3], force[2][3], field[Triangle::fields];
  std::copy(one.field, one.field + Triangle::fields, field);
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 3; ++i) x[k][i] = corners(i, k);
  }
  std::visit([&]<class M>(const M& m) { TriangleFormula<M>(m).energy(x, field, force); }, membrane);
  Six slope;
  for (int i = 0; i < inner; ++i) slope[i] = force[i / 3][i % 3];
  return slope;
}

SixBySix stiffness_at(const Membrane& membrane, const OneTriangle& one, const Mat3& corners, bool project) {
  double x[3][3], packed[21], field[Triangle::fields];
  std::copy(one.field, one.field + Triangle::fields, field);
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 3; ++i) x[k][i] = corners(i, k);
  }
  std::visit([&]<class M>(const M& m) { TriangleFormula<M>(m).stiffness(x, field, project, packed); }, membrane);
  SixBySix full;
  for (int i = 0; i < inner; ++i) {
    for (int j = 0; j <= i; ++j) full(i, j) = full(j, i) = packed[packed_index(i, j)];
  }
  return full;
}

TEST(Cloth, SecondDerivativesOfTrianglesAreThoseOfTheForcesAndProjectedOnesArePositive) {
  std::mt19937 random(5);
  const OneTriangle one;
  for (const Membrane& membrane : test::all_membranes()) {
    for (const char* name : {"near rest", "random", "small", "huge"}) {
      const test::Kind& kind =
          *std::ranges::find_if(test::kinds, [&](const test::Kind& k) { return k.name == std::string(name); });
      for (int sample = 0; sample < 20; ++sample) {
        const Mat3 corners = test::deformation(kind, random) * one.rest;
        const double size = corners.norm();
        double best = 1e300;  // a wrinkled sheet has a kink in its stress, which a large step may cross
        const SixBySix found = stiffness_at(membrane, one, corners, false);
        for (const double step : {1e-5, 1e-6, 1e-7}) {
          SixBySix differences;
          for (int i = 0; i < inner; ++i) {
            Mat3 up = corners, down = corners;
            up(i % 3, 1 + i / 3) += step * size;
            down(i % 3, 1 + i / 3) -= step * size;
            differences.col(i) = (slope_at(membrane, one, up) - slope_at(membrane, one, down)) / (2 * step * size);
          }
          best = std::min(best, (differences - found).norm());
        }
        EXPECT_LT(best, 1e-6 * std::max(found.norm(), 10.0)) << name_of(membrane) << ", " << name << " " << sample;
        const SixBySix projected = stiffness_at(membrane, one, corners, true);
        const double least = projected.selfadjointView<Eigen::Lower>().eigenvalues()[0];
        EXPECT_GE(least, -1e-9 * projected.norm()) << name_of(membrane) << ", " << name << " " << sample;
        const SixBySix more = projected - found;
        EXPECT_GE(more.selfadjointView<Eigen::Lower>().eigenvalues()[0], -1e-9 * (projected.norm() + found.norm()))
            << "projection adds: " << name_of(membrane) << ", " << name << " " << sample;
      }
    }
  }
}

TEST(Cloth, ScalarStiffnessIsAThirdOfTheProjectedTrace) {
  std::mt19937 random(6);
  const OneTriangle one;
  for (const Membrane& membrane : test::all_membranes()) {
    for (int sample = 0; sample < 20; ++sample) {
      const Mat3 corners = test::deformation(test::kinds[1], random) * one.rest;
      double x[3][3], scalar[3], field[Triangle::fields];
      std::copy(one.field, one.field + Triangle::fields, field);
      for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) x[k][i] = corners(i, k);
      }
      std::visit([&]<class M>(const M& m) { TriangleFormula<M>(m).scalar_stiffness(x, field, 0.0, scalar); }, membrane);
      const SixBySix whole = stiffness_at(membrane, one, corners, true);
      const double scale = whole.norm();
      EXPECT_NEAR(scalar[0], whole.topLeftCorner(3, 3).trace() / 3, 1e-9 * scale);
      EXPECT_NEAR(scalar[1], whole.bottomLeftCorner(3, 3).trace() / 3, 1e-9 * scale);
      EXPECT_NEAR(scalar[2], whole.bottomRightCorner(3, 3).trace() / 3, 1e-9 * scale);
    }
  }
}

TEST(Cloth, KernelsInSinglePrecisionAgreeWithThoseInDouble) {
  for (const Membrane& membrane : test::all_membranes()) {
    const Model model = build_model(test::sheet({0.3, 0.2}, {7, 5}, {membrane, 0}));
    const Positions x = test::shaken(model.rest, 0.01, 3);
    const std::size_t lanes = std::size_t(model.blocks) * block_width;
    AlignedVector<double> energy(lanes), single(lanes);
    AlignedVector<double> force(std::size_t(list_stride) * model.largest_chunk), other(force.size()),
        local(force.size());
    const ElementChunk chunk = model.chunk(0);
    element_kernels().elements(chunk, x.data(), nullptr, energy.data(), force.data(), local.data());
    element_kernels().elements_single(chunk, x.data(), nullptr, single.data(), other.data(), local.data());
    const Eigen::Map<Eigen::VectorXd> a(force.data(), std::ssize(force)), b(other.data(), std::ssize(other));
    EXPECT_GT(a.norm(), 0);
    EXPECT_LT((a - b).norm(), 1e-5 * a.norm()) << name_of(membrane);
  }
}

TEST(Cloth, ObjectiveWithBendingHasItsGradientAndItsDifferences) {
  // Sheets that give way have kinks in their stress, at which differences are less exact.
  for (std::size_t m : {0, 2, 4}) {
    const Membrane membrane = test::all_membranes()[m];
    BodyDescription body = test::sheet({0.3, 0.2}, {5, 4}, {membrane, 0.02});
    Handle edge{"edge", {0, 6, 12, 18, 24}};
    test::expect_derivative_of_objective(body, std::string(name_of(membrane)));
    body.handles.push_back(edge);
    body.damping = 0.01;
    test::expect_derivative_of_objective(body, std::string(name_of(membrane)) + ", held and damped");
    body.integrator = Integrator::implicit_midpoint;
    test::expect_derivative_of_objective(body, std::string(name_of(membrane)) + ", implicit midpoint");
  }
}

// Rolls a flat sheet up to a cylinder about an axis with a given direction in the plane.
Positions rolled(const Positions& flat, double radius, double direction) {
  Positions x(flat.rows(), 3);
  const Eigen::Vector2d axis(std::cos(direction), std::sin(direction)), across(-axis.y(), axis.x());
  for (Eigen::Index v = 0; v < flat.rows(); ++v) {
    const Eigen::Vector2d p = flat.row(v).head<2>().transpose();
    const double along = p.dot(axis), angle = p.dot(across) / radius;
    const Eigen::Vector2d in_plane = along * axis + radius * std::sin(angle) * across;
    x.row(v) << in_plane.x(), in_plane.y(), radius * (1 - std::cos(angle));
  }
  return x;
}

// A grid whose inner vertices are moved within the plane, so that no two triangles are alike.
TriMesh uneven_grid(int cells, unsigned seed) {
  TriMesh mesh = cloth_grid({1, 1}, {cells, cells}).surface;
  std::mt19937 random(seed);
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v) {
    const auto inside = [](double t) { return t > 1e-9 && t < 1 - 1e-9; };
    if (!inside(mesh.points(v, 0)) || !inside(mesh.points(v, 1))) continue;
    for (int c = 0; c < 2; ++c) mesh.points(v, c) += test::uniform(random, -0.25, 0.25) / cells;
  }
  return mesh;
}

TEST(Cloth, ASheetBentToACylinderStoresTheEnergyOfAPlateInEveryDirectionAndMesh) {
  constexpr double radius = 0.8, bending = 3e-5;
  const double exact = bending / (2 * radius * radius);
  const Membrane membrane = test::all_membranes().front();
  for (const double direction : {0.0, 0.3, std::numbers::pi / 4, 1.2, std::numbers::pi / 2, -std::numbers::pi / 4}) {
    double before = 1;
    for (const int cells : {24, 48}) {
      const BodyDescription even = test::sheet({1, 1}, {cells, cells}, {membrane, bending});
      const BodyDescription uneven = test::sheet_of(uneven_grid(cells, 4), {membrane, bending});
      for (const BodyDescription* body : {&even, &uneven}) {
        const Model model = build_model(*body);
        const double found = bending_energy(model, rolled(model.rest, radius, direction)) / exact;
        // A free border is not bent across; that strip has the width of part of a triangle. On an uneven mesh, vertices
        // that lie on a cylinder are not what bends least.
        EXPECT_NEAR(found, 1, body == &even ? 1.5 / cells : 0.15) << cells << " cells, " << direction;
        if (body == &even) before = std::abs(found - 1);
      }
    }
    EXPECT_LT(before, 0.027);
  }
}

TEST(Cloth, BendingKnowsNeitherPlaceNorTurnAndAFlatSheetHasNone) {
  const Model model = build_model(test::sheet_of(uneven_grid(8, 2), {test::all_membranes().front(), 1e-4}));
  const Positions bent = rolled(model.rest, 0.4, 0.7);
  const double energy = bending_energy(model, bent);
  std::mt19937 random(3);
  const Mat3 turn = test::random_rotation(random);
  Positions elsewhere = bent * turn.transpose(), flat = model.rest * turn.transpose();
  elsewhere.rowwise() += Eigen::RowVector3d(1000, -2000, 500);
  EXPECT_NEAR(bending_energy(model, elsewhere), energy, 1e-8 * energy);
  EXPECT_LT(std::abs(bending_energy(model, flat)), 1e-12 * energy);
}

TEST(Cloth, ForcesOfBendingAreThoseOfTheRowsOfQOnEveryMachine) {
  const Model model = build_model(test::sheet_of(uneven_grid(8, 2), {test::all_membranes().front(), 1e-4}));
  const Positions bent = rolled(model.rest, 0.4, 0.7);
  BendingRoom room;
  room.take(bent.data(), model.vertices);
  const Model::SparseRows& q = model.bending;
  const DifferenceRows rows{q.begin.data(), q.column.data(), q.value.data()};
  for (int variant = 0; variant < runnable_variants(); ++variant) {
    const LinearKernels& kernels = linear_kernels(variant);
    room.forces.assign(room.forces.size(), -1);
    room.squares.assign(room.squares.size(), -1);
    kernels.difference_rows(rows, room.places.data(), 3, model.vertices, room.forces.data(), room.squares.data());
    EXPECT_EQ(room.squares[2], -1) << "rows before the first one were written";
    kernels.difference_rows(rows, room.places.data(), 0, 3, room.forces.data(), room.squares.data());
    double energy = 0, largest = 0, apart = 0;
    for (int v = 0; v < model.vertices; ++v) {
      energy -= 0.25 * room.squares[std::size_t(v)];
      double row[3];
      bending_row(q, bent.data(), v, row);
      for (int c = 0; c < 3; ++c) {
        largest = std::max(largest, std::abs(row[c]));
        apart = std::max(apart, std::abs(room.forces[4 * std::size_t(v) + std::size_t(c)] - row[c]));
      }
    }
    EXPECT_NEAR(energy, bending_energy(model, bent), 1e-12 * energy);
    EXPECT_LT(apart, 1e-12 * largest);
    const auto forces = room.forces;
    kernels.difference_rows(rows, room.places.data(), 0, model.vertices, room.forces.data(), nullptr);
    EXPECT_EQ(room.forces, forces) << "without squares";
  }
}

}  // namespace cloth_test
}  // namespace supple
