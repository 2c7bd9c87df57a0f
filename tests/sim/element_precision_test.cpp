// Tests when steps evaluate elements in single precision, and that what a step leaves is double.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/solver/element_precision.h"
#include "sim/solver/objective.h"
#include "support/bodies.h"

namespace supple {
namespace element_precision_test {

// Holds a bar that hangs from its end, after some steps of its fall with elements in the wanted precision.
struct Falling {
  Model model;
  StepInputs inputs;
  State state;
  OpenWorkspace w;
  StepReport report;

  Falling(const Material& material, Precision elements, int steps)
      : model(build_model(test::bar(material, test::Held::hard_end, Precision::double_precision, 2))),
        inputs(test::still_inputs(model)),
        state(rest_state(model)) {
    inputs.solver.elements = elements;
    for (int i = 0; i < steps; ++i) report = step(model, inputs, state, w);
  }
};

TEST(ElementPrecision, ASoftBodyMovesAsInDoublePrecision) {
  const Material soft = StableNeoHookean::from({2e4, 5e4});
  const Falling single(soft, Precision::single_precision, 8), plain(soft, Precision::double_precision, 8);
  EXPECT_TRUE(single.state.memory.began_in_single);
  EXPECT_FALSE(plain.state.memory.began_in_single);
  const double apart = (single.state.x - plain.state.x).cwiseAbs().maxCoeff() / plain.model.size;
  EXPECT_GT(apart, 0) << "nothing was evaluated in single precision";
  EXPECT_LT(apart, 1e-5);
  EXPECT_LT(single.report.error_estimate, 1.5 * plain.report.error_estimate + 1e-9);
}

TEST(ElementPrecision, AStiffBodyHasTheBitsOfDoublePrecision) {
  const Material stiff = Corotated{4e10, 6e10};
  const Falling single(stiff, Precision::single_precision, 5), plain(stiff, Precision::double_precision, 5);
  EXPECT_FALSE(single.state.memory.began_in_single);
  EXPECT_EQ(single.state.x, plain.state.x);
}

TEST(ElementPrecision, ABodyWithSlackHasTheBitsOfDoublePrecision) {
  const Material slack = StrainLimiting{1e5, 0.9, 1.1, 1e6, 0.8, 1.2};
  EXPECT_TRUE(has_slack(slack));
  const Falling single(slack, Precision::single_precision, 5), plain(slack, Precision::double_precision, 5);
  EXPECT_EQ(single.state.x, plain.state.x);
}

TEST(ElementPrecision, WhatAStepLeavesIsDouble) {
  Falling single(StableNeoHookean::from({2e4, 5e4}), Precision::single_precision, 6);
  OpenWorkspace& w = single.w;
  ASSERT_TRUE(w.began_in_single);
  EXPECT_EQ(w.elements, Precision::double_precision);
  const double elastic = w.current.elastic, g = w.current.g;
  const Positions gradient = w.current.gradient;
  w.current.x = single.state.x;
  evaluate(single.model, w, w.current, Wanted::gradient);
  EXPECT_NEAR(elastic / w.current.elastic, 1, 1e-14);
  EXPECT_NEAR(g / w.current.g, 1, 1e-14);
  EXPECT_EQ(gradient, w.current.gradient);
  EXPECT_EQ(single.report.objective.back(), g);
}

// A step of 1,000 iterations goes on until nothing is left, below what single precision can tell.
TEST(ElementPrecision, ElementsThatAreAlikeErrToOneSideByNoMoreThanTheBias) {
  // A fortieth of these is no number of single precision.
  const Membrane membrane = test::all_membranes().front();
  for (const double extent : {14.5, 1.6, 3.3}) {
    const Model sheet = build_model(test::sheet({extent, extent}, {40, 40}, {membrane, 0}));
    OpenWorkspace w;
    w.prepare(sheet, {});
    w.y = sheet.rest;
    w.current.x = 1.03 * sheet.rest;
    evaluate(sheet, w, w.current, Wanted::value);
    const double exact = w.current.elastic;
    w.elements = Precision::single_precision;
    evaluate(sheet, w, w.current, Wanted::value);
    EXPECT_NE(w.current.elastic, exact);
    EXPECT_LT(std::abs(w.current.elastic - exact), single_bias_of(sheet, exact)) << extent;
  }
}

TEST(ElementPrecision, ASearchGoesOverToDoubleBeforeRoundOffMatters) {
  double left[2];
  for (const Precision elements : {Precision::single_precision, Precision::double_precision}) {
    Falling falling(StableNeoHookean::from({2e4, 5e4}), elements, 3);
    falling.inputs.solver.iterations = 1000;
    const StepReport& report = step(falling.model, falling.inputs, falling.state, falling.w);
    EXPECT_EQ(falling.w.began_in_single, elements == Precision::single_precision);
    left[elements == Precision::single_precision ? 0 : 1] = report.decrement;
  }
  EXPECT_LT(left[0], 10 * left[1] + 1e-15);
}

}  // namespace element_precision_test
}  // namespace supple
