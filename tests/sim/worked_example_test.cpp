// Tests the example of docs/adding-a-material.md: the page shows it as it is compiled here, and it is correct.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <xsimd/xsimd.hpp>

#include "sim/elements/dual.h"
#include "sim/elements/tetrahedron.h"
#include "sim/worked_example/hardening.h"
#include "support/bodies.h"

namespace supple {
namespace worked_example_test {

TEST(WorkedExample, StandsOnThePageAsItIsCompiled) {
  const std::string page = test::read_file(test::source_folder / "docs" / "adding-a-material.md");
  const std::string header = test::read_file(test::source_folder / "tests" / "sim" / "worked_example" / "hardening.h");
  EXPECT_NE(page.find("```cpp\n" + header + "```"), std::string::npos);
}

TEST(WorkedExample, IsTheDerivativeOfItsEnergyAndTheSumOverItsStretches) {
  const Hardening material{3, 50};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  for (int sample = 0; sample < 100; ++sample) {
    Matrix3<double> f, stress, direction, ahead, behind, unused;
    for (int i = 0; i < 9; ++i) f.m[i] = (i % 4 == 0) + uniform(random);
    for (double& d : direction.m) d = uniform(random);
    const double energy = density_of(material, f, stress), h = 1e-6;
    double slope = 0;
    for (int i = 0; i < 9; ++i) {
      slope += stress.m[i] * direction.m[i];
      ahead.m[i] = f.m[i] + h * direction.m[i];
      behind.m[i] = f.m[i] - h * direction.m[i];
    }
    const double difference = (density_of(material, ahead, unused) - density_of(material, behind, unused)) / (2 * h);
    EXPECT_NEAR(slope, difference, 1e-7 * (1 + std::abs(slope)));
    double sum = 0;
    for (const double s : svd(f).s) sum += 3 * std::pow(s - 1, 2) + 50 * std::pow(s - 1, 6);
    EXPECT_NEAR(energy, sum, 1e-11 * (1 + sum));
    // The vector lanes must give the same.
    using V = xsimd::batch<double>;
    Matrix3<V> wide, wide_stress;
    for (int i = 0; i < 9; ++i) wide.m[i] = V(f.m[i]);
    EXPECT_NEAR(density_of(material, wide, wide_stress).get(0), energy, 1e-11 * (1 + energy));
  }
  EXPECT_NEAR(material.axial_stress(1.3), 2 * 3 * 0.3 + 6 * 50 * std::pow(0.3, 5), 1e-12);
}

TEST(WorkedExample, HasSecondDerivativesThroughDualNumbers) {
  const Hardening material{3, 50};
  using D = Dual<double>;
  const D one(1.0), zero(0.0), x = D::variable(1.3, 0);
  Symmetric3<D> slope;
  const D energy = material.density(Symmetric3<D>{x, one, one, zero, zero, zero}, slope);
  EXPECT_NEAR(energy.d[0], slope.xx.value, 1e-12);
  EXPECT_NEAR(slope.xx.d[0], 2 * 3 + 30 * 50 * std::pow(0.3, 4), 1e-12);
}

}  // namespace worked_example_test
}  // namespace supple
