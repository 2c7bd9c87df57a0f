// Tests what the lengths of a search's directions foretell, on series whose sum is known.
#include "sim/solver/direction_lengths.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/model/joined_model.h"
#include "sim/model/motion_error.h"
#include "support/contact_scene.h"

namespace supple {
namespace direction_lengths_test {

// Returns a way of a model's free vertices, all of which move as far [m].
Positions way(const Model& model, double distance) {
  return Positions::Constant(model.free, 3, distance / std::sqrt(3.0));
}

// Adds directions of which each is `rate` times as long as the one before, the first of this distance [m].
void add_series(const Model& model, double distance, double rate, int count, DirectionLengths& lengths) {
  for (int k = 0; k < count; ++k, distance *= rate) lengths.add(model, way(model, distance), 1);
}

TEST(DirectionLengths, ForetellTheSumOfAGeometricSeries) {
  const Model model = build_model(test::cube(3));
  const double unit = mass_length(model, model.parts[0], way(model, 1));
  for (const double rate : {1e-3, 0.2, 0.5, 0.89}) {
    for (const int count : {2, 3, 5, 12}) {
      DirectionLengths lengths;
      lengths.begin(model);
      add_series(model, 7, rate, count, lengths);
      const double sum = 7 * std::pow(rate, count) / (1 - rate);
      EXPECT_NEAR(lengths.left(0) / (unit * sum), 1, 1e-9) << rate << ", " << count;
    }
  }
}

TEST(DirectionLengths, ForetellNineDirectionsAtMostWhereTheyDoNotShrink) {
  const Model model = build_model(test::cube(3));
  const double unit = mass_length(model, model.parts[0], way(model, 1));
  DirectionLengths lengths;
  lengths.begin(model);
  add_series(model, 2, 1, 6, lengths);
  EXPECT_NEAR(lengths.left(0), 9 * 2 * unit, 1e-9 * unit);
}

TEST(DirectionLengths, ForetellNothingFromOneDirectionOrOneWithoutLength) {
  const Model model = build_model(test::cube(3));
  DirectionLengths lengths;
  lengths.begin(model);
  add_series(model, 2, 0.5, 1, lengths);
  EXPECT_EQ(lengths.left(0), 0);
  lengths.add(model, way(model, 0), 1);
  EXPECT_EQ(lengths.left(0), 0);
}

TEST(DirectionLengths, ForgetWhatIsFiveDirectionsOldAndEarlierSteps) {
  const Model model = build_model(test::cube(3));
  const double unit = mass_length(model, model.parts[0], way(model, 1));
  DirectionLengths lengths;
  lengths.begin(model);
  add_series(model, 1e6, 0.99, 9, lengths);
  add_series(model, 1, 0.5, 5, lengths);
  EXPECT_NEAR(lengths.left(0) / (unit * std::pow(0.5, 4)), 1, 1e-9);
  lengths.begin(model);
  EXPECT_EQ(lengths.left(0), 0);
}

// Where a quarter of each direction was taken, the minimum is as far as where all of it was. A direction that is
// refused until next to nothing is left of it tells nothing of the minimum.
TEST(DirectionLengths, CountWholeDirectionsUnlessNextToNothingWasTaken) {
  const Model model = build_model(test::cube(3));
  const auto left = [&](double accepted) {
    DirectionLengths lengths;
    lengths.begin(model);
    for (const double distance : {4.0, 2.0, 1.0}) lengths.add(model, way(model, distance), accepted);
    return lengths.left(0);
  };
  EXPECT_EQ(left(0.25), left(1));
  EXPECT_EQ(left(0.01), left(1));
  EXPECT_NEAR(left(1e-6) / left(1), 1e-4, 1e-9);
}

TEST(DirectionLengths, AreThoseOfEachPart) {
  const Model slow = build_model(test::cube(3)), fast = build_model(test::cube(2));
  const Model both = join({&slow, &fast});
  DirectionLengths of_both, of_slow, of_fast;
  of_both.begin(both);
  of_slow.begin(slow);
  of_fast.begin(fast);
  for (int k = 0; k < 4; ++k) {
    Positions d(both.free, 3);
    d.middleRows(both.parts[0].first_free, slow.free) = way(slow, std::pow(0.8, k));
    d.middleRows(both.parts[1].first_free, fast.free) = way(fast, std::pow(0.1, k));
    of_both.add(both, d, 1);
    of_slow.add(slow, way(slow, std::pow(0.8, k)), 1);
    of_fast.add(fast, way(fast, std::pow(0.1, k)), 1);
  }
  EXPECT_NEAR(of_both.left(0) / of_slow.left(0), 1, 1e-9);
  EXPECT_NEAR(of_both.left(1) / of_fast.left(0), 1, 1e-9);
}

}  // namespace direction_lengths_test
}  // namespace supple
