// Tests solves in parts, and entries of the inverse, against whole solves.
#include "sim/linear/parted_solve.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numeric>

#include "base/threads.h"
#include "base/variants.h"
#include "sim/linear/inverse_entries.h"
#include "sim/model/model.h"
#include "support/bodies.h"

namespace supple {
namespace parted_solve_test {

using test::bar;
using test::Held;
using test::shaken;

Model bar_of(Precision precision) { return build_model(bar(Corotated{1e4, 3e4}, Held::hard_end, precision, 3)); }

double tolerance_of(Precision precision) { return precision == Precision::single_precision ? 2e-6 : 1e-12; }

Positions solved(const Model& model, const Positions& b) {
  Positions x(model.free, 3);
  AlignedVector<double> scratch;
  model.factor.solve(b.data(), x.data(), scratch);
  return x;
}

TEST(PartedSolve, LookingAtAPartFindsTheNumbersOfTheWholeSolveExactly) {
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    const Model model = bar_of(precision);
    const Positions b = shaken(Positions::Zero(model.free, 3), 1, 3), whole = solved(model, b);
    const std::vector<std::int32_t> few = {0, 7, model.free / 2};
    const FactorPart part = paths_to_root(model.factor, few);
    EXPECT_LT(part.size(), std::size_t(model.factor.view().strip_count));
    PartedSolve parted;
    parted.begin(model.factor, b.data());
    parted.look(part);
    for (const std::int32_t unknown : few) EXPECT_EQ(parted.seen(unknown), Vec3(whole.row(unknown)));
    Positions x(model.free, 3);
    parted.finish(x.data());
    EXPECT_EQ(x, whole);
  }
}

TEST(PartedSolve, WhatIsAddedAtAFewUnknownsIsSolvedForAsIfItHadBeenThereFromTheStart) {
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    const Model model = bar_of(precision);
    const std::vector<std::int32_t> few = {3, model.free - 1};
    const FactorPart part = paths_to_root(model.factor, few);
    for (const double magnitude : {0.0, 1.0}) {
      Positions b = magnitude * shaken(Positions::Zero(model.free, 3), 1, 4), x(model.free, 3);
      PartedSolve parted;
      if (magnitude > 0) {
        parted.begin(model.factor, b.data());
      } else {
        parted.begin_from_zero(model.factor, 1);
      }
      parted.clear_addition(part);
      for (const std::int32_t unknown : few) {
        const Vec3 more(0.5, -2, unknown);
        parted.add(unknown, more);
        b.row(unknown) += more.transpose();
      }
      parted.pass_on(part);
      parted.finish(x.data());
      const Positions whole = solved(model, b);
      EXPECT_LT((x - whole).norm(), tolerance_of(precision) * whole.norm());
    }
  }
}

// The body is large enough that several batches of columns are computed at once.
TEST(InverseEntries, AreThoseOfTheDenseInverseWhateverWasAskedForBefore) {
  Threads two(2);
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    const Model model = bar_of(precision);
    std::vector<std::int32_t> all(model.free);
    std::iota(all.begin(), all.end(), 0);
    InverseEntries together, by_two;
    together.learn(model.factor, all, nullptr);
    by_two.learn(model.factor, {7, 3, 3, model.free - 1}, &two);
    by_two.learn(model.factor, all, &two);
    for (std::int32_t a = 0; a < model.free; a += 11) {
      Positions unit = Positions::Zero(model.free, 3);
      unit(a, 0) = 1;
      const Positions column = solved(model, unit);
      for (std::int32_t b = 0; b < model.free; b += 5) {
        const float entry = together.entry(a, b);
        EXPECT_NEAR(entry, column(b, 0), 1e-5 * column.col(0).maxCoeff());
        EXPECT_EQ(entry, together.entry(b, a));
        EXPECT_EQ(entry, by_two.entry(a, b));
        InverseEntries alone;
        alone.learn(model.factor, {b, a}, nullptr);
        EXPECT_EQ(alone.entry(b, a), entry);
      }
    }
  }
}

TEST(InverseEntries, OfPartsThatDoNotHoldTogetherAreZero) {
  BodyDescription body = bar(Corotated{1e4, 3e4}, Held::nothing, Precision::double_precision, 2);
  const auto count = static_cast<int>(body.mesh.rest.rows());
  TetMesh& mesh = body.mesh;
  const TetMesh one = mesh;
  mesh.rest.conservativeResize(2 * count, 3);
  mesh.rest.bottomRows(count) = one.rest.rowwise() + Eigen::RowVector3d(0, 10, 0);
  mesh.tets.conservativeResize(2 * one.tets.rows(), 4);
  mesh.tets.bottomRows(one.tets.rows()) = one.tets.array() + count;
  mesh.regions.resize(mesh.tets.rows(), 0);
  const Model model = build_model(body);
  std::vector<std::int32_t> all(model.free);
  std::iota(all.begin(), all.end(), 0);
  InverseEntries entries;
  entries.learn(model.factor, all, nullptr);
  int apart = 0;
  for (const std::int32_t a : all) {
    for (const std::int32_t b : all) {
      if ((model.input_of[a] < count) == (model.input_of[b] < count)) continue;
      EXPECT_EQ(entries.entry(a, b), 0);
      ++apart;
    }
  }
  EXPECT_EQ(apart, 2 * count * count);
  // They take no memory: two equal trees have twice what one has.
  std::vector<std::int32_t> of_one;
  for (const std::int32_t a : all) {
    if (model.input_of[a] < count) of_one.push_back(a);
  }
  InverseEntries one_part;
  one_part.learn(model.factor, of_one, nullptr);
  EXPECT_EQ(entries.stored_numbers(), 2 * one_part.stored_numbers());
}

// Tests every instruction set with lengths around its registers; each product is the same whatever stands beside it.
TEST(Kernels, MultiplyTheCommonEndsOfVectors) {
  constexpr int count = product_tile * product_tile;
  AlignedVector<float> numbers(2 * product_tile * 128);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<float>(std::sin(1.0 + double(i * i)));
  const float *a[product_tile], *b[product_tile];
  for (int i = 0; i < product_tile; ++i) {
    a[i] = &numbers[128 * i] + 128;
    b[i] = &numbers[128 * (i + product_tile)] + 128;
  }
  for (int variant = 0; variant < runnable_variants(); ++variant) {
    const LinearKernels& kernels = linear_kernels(variant);
    for (int length = 0; length <= 128; ++length) {
      std::int32_t lengths[count];
      for (int i = 0; i < count; ++i) lengths[i] = (length + 7 * i) % 129;
      lengths[0] = length;
      float products[count], same[count];
      kernels.end_products(a, b, lengths, products);
      for (int i = 0; i < count; ++i) {
        const float *u = a[i / product_tile], *v = b[i % product_tile];
        double sum = 0;
        for (int k = 1; k <= lengths[i]; ++k) sum += double(u[-k]) * v[-k];
        EXPECT_NEAR(products[i], sum, 1e-5) << variant << " " << lengths[i];
      }
      const std::vector<std::int32_t> equal(count, length);
      kernels.end_products(a, b, equal.data(), same);
      EXPECT_EQ(same[0], products[0]);
    }
  }
}

}  // namespace parted_solve_test
}  // namespace supple
