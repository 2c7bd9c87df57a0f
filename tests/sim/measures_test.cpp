#include "sim/measures/measures.h"
#include "base/variants.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "sim/model/element_view.h"
#include "support/bodies.h"

namespace supple {
namespace measures_test {

// Compares, for every instruction set, the largest stretch and the volume of each element with those of a singular
// value decomposition.
void expect_stretches(const Model& model, const Positions& x) {
  for (int v = 0; v < runnable_variants(); ++v) {
    for (std::size_t c = 0; c < model.chunks.size(); ++c) {
      const Model::ChunkRange& range = model.chunks[c];
      std::vector<double> largest(range.blocks * block_width), volume(range.blocks * block_width);
      element_kernels(v).stretches(model.chunk(static_cast<int>(c)), x.data(), largest.data(), volume.data());
      for_each_element(model, range, [&](const ElementView& element) {
        const int lane = element.lane - range.first_block * block_width;
        const Mat3 f = deformation_gradient(x, element);
        const Eigen::JacobiSVD<Mat3> svd(f);
        EXPECT_NEAR(largest[lane], svd.singularValues()[0], 1e-7 * svd.singularValues()[0]) << variant_name(v);
        EXPECT_NEAR(volume[lane], f.determinant(), 1e-12 * std::pow(svd.singularValues()[0], 3)) << variant_name(v);
      });
    }
  }
}

TEST(Measures, StretchesAreSingularValues) {
  const BodyDescription bar =
      test::bar(test::all_materials().front(), test::Held::nothing, Precision::double_precision, 3);
  const Model model = build_model(bar);
  const Positions& rest = model.rest;
  expect_stretches(model, rest);
  for (const unsigned seed : {1u, 2u, 3u}) {
    for (const double amount : {1e-9, 1e-4, 0.02, 1.0}) expect_stretches(model, test::shaken(rest, amount, seed));
  }
  expect_stretches(model, Positions::Zero(rest.rows(), 3));  // all vertices lie in one point
  Positions flat = rest;
  flat.col(1).setZero();
  expect_stretches(model, flat);
}

TEST(Measures, TheTopOfTheStretchesAndInvertedElementsAreCounted) {
  const Model model = build_model(test::bar(test::all_materials().front(), test::Held::nothing));
  Positions x = model.rest;
  EXPECT_NEAR(deformation(model, x).stretch, 1, 1e-7);
  EXPECT_EQ(deformation(model, x).inverted, 0);
  x.col(2) *= 1.75;
  EXPECT_NEAR(deformation(model, x).stretch, 1.75, 1e-7);
  x.col(0) *= -0.5;
  EXPECT_EQ(deformation(model, x).inverted, model.elements);
}

TEST(Measures, OfSpringsByTheirLengths) {
  const Model model = build_model(test::spring_net(6));
  Positions x = model.rest;
  EXPECT_DOUBLE_EQ(deformation(model, x).stretch, 1);
  x *= 1.25;
  EXPECT_DOUBLE_EQ(deformation(model, x).stretch, 1.25);
  EXPECT_EQ(deformation(model, x).inverted, 0);
}

}  // namespace measures_test
}  // namespace supple
