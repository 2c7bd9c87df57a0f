// Tests solves in parts, and entries of the inverse, against whole solves.
#include "sim/linear/parted_solve.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numeric>

#include "sim/linear/inverse_entries.h"
#include "sim/model/model.h"
#include "support/bodies.h"

namespace supple {
namespace {

using test::bar;
using test::Held;
using test::shaken;

Model bar_of(Precision precision) { return build_model(bar(Corotated{1e4, 3e4}, Held::hard_end, precision, 3)); }

double tolerance_of(Precision precision) { return precision == Precision::single_precision ? 2e-6 : 1e-12; }

Positions solved(const Model& model, const Positions& b) {
  Positions x(model.free, 3);
  AlignedVector<double> scratch(4 * std::size_t(model.free));
  model.factor.solve(b.data(), x.data(), scratch.data());
  return x;
}

TEST(PartedSolve, LookingAtAPartFindsTheNumbersOfTheWholeSolveExactly) {
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    const Model model = bar_of(precision);
    const Positions b = shaken(Positions::Zero(model.free, 3), 1, 3), whole = solved(model, b);
    const std::vector<std::int32_t> few = {0, 7, model.free / 2};
    const FactorPart part = paths_to_root(model.factor, few);
    EXPECT_LT(part.size(), std::size_t(model.factor.view().panels));
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

TEST(InverseEntries, AreThoseOfTheDenseInverseWhateverWasAskedForBefore) {
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    const Model model = bar_of(precision);
    std::vector<std::int32_t> all(model.free);
    std::iota(all.begin(), all.end(), 0);
    InverseEntries together;
    together.learn(model.factor, all);
    for (std::int32_t a = 0; a < model.free; a += 11) {
      Positions unit = Positions::Zero(model.free, 3);
      unit(a, 0) = 1;
      const Positions column = solved(model, unit);
      for (std::int32_t b = 0; b < model.free; b += 5) {
        const float entry = together.entry(model.factor, a, b);
        EXPECT_NEAR(entry, column(b, 0), 1e-5 * column.col(0).maxCoeff());
        EXPECT_EQ(entry, together.entry(model.factor, b, a));
        InverseEntries alone;
        alone.learn(model.factor, {b, a});
        EXPECT_EQ(alone.entry(model.factor, b, a), entry);
      }
    }
  }
}

}  // namespace
}  // namespace supple
