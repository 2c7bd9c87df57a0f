// Tests the energies of materials (their sums over stretches, at rest, at small strains, where they are continued and
// where the rotation is not unique), polar rotations, the quadrature of equation 11, and the SIMD kernels against the
// plain formulas. Not here: forces against differences of energies (derivative_table_test.cpp), stresses
// (stress_test.cpp).
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <xsimd/xsimd.hpp>

#include "base/variants.h"
#include "sim/elements/element_kernels.h"
#include "sim/elements/tetrahedron.h"
#include "support/bodies.h"
#include "support/deformations.h"

namespace supple {
namespace material_test {

using test::all_materials;
using test::deformation;
using test::Kind;
using test::kinds;
using test::random_rotation;
using test::uniform;

Matrix3<double> plain(const Mat3& f) {
  Matrix3<double> m;
  for (int i = 0; i < 9; ++i) m.m[i] = f(i / 3, i % 3);
  return m;
}

// Computes the energy density and the first Piola-Kirchhoff stress by the plain path.
double density(const Material& material, const Mat3& f, Mat3* stress) {
  return std::visit(
      [&](const auto& m) {
        Matrix3<double> p;
        const double energy = density_of(m, plain(f), p);
        if (stress != nullptr) {
          for (int i = 0; i < 9; ++i) (*stress)(i / 3, i % 3) = p.m[i];
        }
        return energy;
      },
      material);
}

TEST(Materials, EnergyIsTheValanisLandelSumOfItsStretches) {
  // Evaluates equation 9 at random stretches, with a, b and c as they follow from the energies in docs/method.md.
  std::mt19937 random(8);
  for (int sample = 0; sample < 100; ++sample) {
    const Vec3 s(uniform(random, 0.4, 2), uniform(random, 0.4, 2), uniform(random, 0.4, 2));
    const Mat3 f = random_rotation(random) * s.asDiagonal() * random_rotation(random);
    const double mu = 3, lambda = 5, j = s.prod();
    const auto sum = [&](auto a) { return a(s[0]) + a(s[1]) + a(s[2]); };
    const double pairs = s[0] * s[1] + s[1] * s[2] + s[2] * s[0];
    EXPECT_NEAR(density(AsRigidAsPossible{mu}, f, nullptr), sum([&](double x) { return mu * (x - 1) * (x - 1); }),
                1e-11);
    EXPECT_NEAR(density(Polynomial{mu}, f, nullptr), sum([&](double x) { return mu * std::pow(x - 1, 4); }), 1e-11);
    EXPECT_NEAR(
        density(Corotated{mu, lambda}, f, nullptr),
        sum([&](double x) { return mu * (x - 1) * (x - 1) + lambda / 2 * (x * x - 6 * x + 3); }) + lambda * pairs,
        1e-11);
    EXPECT_NEAR(
        density(NeoHookean{mu, lambda}, f, nullptr),
        sum([&](double x) { return mu / 2 * (x * x - 1); }) - mu * std::log(j) + lambda / 2 * std::log(j) * std::log(j),
        1e-11);
  }
}

TEST(Materials, EnergyAndStressVanishAtRestAndUnderRotation) {
  std::mt19937 random(9);
  for (const Material& material : all_materials()) {
    for (int sample = 0; sample < 20; ++sample) {
      Mat3 stress;
      const double energy = density(material, random_rotation(random), &stress);
      EXPECT_NEAR(energy, 0, 1e-13 * 1e4) << name_of(material);  // moduli are about 1e4
      EXPECT_LT(stress.norm(), 1e-13 * 1e4) << name_of(material);
    }
  }
}

// The energy of a small strain is a form of second order in it (of fourth order for the polynomial), however the
// element is turned: what round-off adds must vanish with the strain, or a body at rest is all noise to a line search.
TEST(Materials, SmallStrainsKeepTheDigitsOfTheirEnergy) {
  std::mt19937 random(12);
  for (const Material& material : all_materials()) {
    if (std::holds_alternative<StrainLimiting>(material)) continue;  // no energy at all
    const double order = std::holds_alternative<Polynomial>(material) ? 4 : 2;
    for (int sample = 0; sample < 20; ++sample) {
      const Mat3 turn = random_rotation(random), strain = Mat3::Random() + Mat3::Identity();
      const auto form = [&](double t) {
        return density(material, turn * (Mat3::Identity() + t * strain), nullptr) / std::pow(t, order);
      };
      const double large = form(1e-4), small = form(1e-8);
      EXPECT_NEAR(small, large, 0.01 * large) << name_of(material);
      EXPECT_EQ(density(material, Mat3::Identity(), nullptr), 0) << name_of(material);
    }
  }
}

TEST(Materials, StableNeoHookeanIsPushedAwayFromThePointByEveryPoissonsRatio) {
  for (const double poisson : {0.0, 0.2, 0.4, 0.49}) {
    const Material material = StableNeoHookean::from(Lame::from_young(1e4, poisson));
    const double point = density(material, Mat3::Zero(), nullptr);
    EXPECT_GT(point, density(material, 0.01 * Mat3::Identity(), nullptr)) << poisson;
    EXPECT_GT(point, 0.1 * 1e4) << poisson;
    EXPECT_FALSE(energy_may_be_negative(material)) << poisson;
    double last = point;
    for (double s = 0.02; s < 1; s += 0.02) {  // downhill all the way to rest
      const double energy = density(material, s * Mat3::Identity(), nullptr);
      EXPECT_LT(energy, last) << poisson << " at " << s;
      last = energy;
    }
  }
}

TEST(Materials, NeoHookeanContinuesSmoothlyBelowItsSmallestVolumeRatio) {
  const NeoHookean material{2, 3};
  const double j = LogVolume::smallest_ratio, step = 1e-7;
  const auto slope = [&](double ratio) {  // dPsi/dJ along F = diag(1, 1, J), without the part mu J of mu/2 tr F^T F
    Mat3 f = Mat3::Identity(), stress;
    f(2, 2) = ratio;
    density(material, f, &stress);
    return stress(2, 2) - 2 * ratio;
  };
  EXPECT_NEAR(slope(j - step), slope(j + step), 1e-3);
  EXPECT_NEAR((slope(j - step) - slope(j - 2 * step)) / step, (slope(j + 2 * step) - slope(j + step)) / step, 0.05);
  Mat3 stress;
  EXPECT_TRUE(std::isfinite(density(material, Mat3::Zero(), &stress)));
  EXPECT_TRUE(stress.allFinite());
}

TEST(Materials, ForceIsFiniteWhereTheRotationIsNotUnique) {
  // Where s2 + s3 = 0, the energy has a kink.
  for (const Material& material : all_materials()) {
    for (const Vec3& s : {Vec3(1, 0.5, -0.5), Vec3(1, 0, 0), Vec3(0, 0, 0), Vec3(-1, -1, -1)}) {
      Mat3 stress;
      EXPECT_TRUE(std::isfinite(density(material, s.asDiagonal(), &stress)));
      EXPECT_TRUE(stress.allFinite()) << name_of(material) << " at " << s.transpose();
    }
  }
}

TEST(Polar, SimdRotationEqualsThatOfTheSingularValuesForEveryKindOfDeformation) {
  using V = xsimd::batch<double>;
  std::mt19937 random(10);
  double worst = 0, worst_orthogonality = 0;
  for (const Kind& kind : kinds) {
    for (int sample = 0; sample < 4000; ++sample) {
      Mat3 f[V::size];
      alignas(64) double lanes[9][V::size];
      for (std::size_t lane = 0; lane < V::size; ++lane) {
        f[lane] = deformation(kind, random);
        for (int i = 0; i < 9; ++i) lanes[i][lane] = f[lane](i / 3, i % 3);
      }
      Matrix3<V> wide;
      for (int i = 0; i < 9; ++i) wide.m[i] = V::load_aligned(lanes[i]);
      const Matrix3<V> r = polar_rotation(wide);
      for (int i = 0; i < 9; ++i) r.m[i].store_aligned(lanes[i]);
      for (std::size_t lane = 0; lane < V::size; ++lane) {
        Mat3 found, expected;
        const Matrix3<double> one = polar_rotation(plain(f[lane]));
        for (int i = 0; i < 9; ++i) {
          found(i / 3, i % 3) = lanes[i][lane];
          expected(i / 3, i % 3) = one.m[i];
        }
        worst = std::max(worst, (found - expected).norm());
        worst_orthogonality = std::max(worst_orthogonality, (found.transpose() * found - Mat3::Identity()).norm());
        EXPECT_GT(found.determinant(), 0);
      }
    }
  }
  EXPECT_LT(worst, 1e-11);
  EXPECT_LT(worst_orthogonality, 1e-11);
}

TEST(Polar, PlainRotationMaximisesTheTraceAsTheSvdDoes) {
  std::mt19937 random(11);
  for (const Kind& kind : kinds) {
    for (int sample = 0; sample < 200; ++sample) {
      const Mat3 f = deformation(kind, random);
      Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
      Vec3 sign = Vec3::Ones();
      sign[2] = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
      const Mat3 expected = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
      const Matrix3<double> r = polar_rotation(plain(f));
      Mat3 found;
      for (int i = 0; i < 9; ++i) found(i / 3, i % 3) = r.m[i];
      EXPECT_LT((found - expected).norm(), 1e-11) << kind.name;
    }
  }
}

TEST(Stiffness, IsIntegratedInSmoothPartsWhereAMaterialIsContinued) {
  double sum = 0;
  const int cells = 200000;
  for (int i = 0; i < cells; ++i) {
    const double s = 0.02 + (1.5 - 0.02) * (i + 0.5) / cells;
    sum += (s - 1) * NeoHookean{3, 5}.axial_stress(s) * (1.5 - 0.02) / cells;
  }
  EXPECT_NEAR(fitted_stiffness(NeoHookean{3, 5}, {0.02, 1.5}) / (sum / ((0.125 + std::pow(0.98, 3)) / 3)), 1, 1e-7);
}

// Compares the kernels of a variant, in both precisions, with the energy and the forces (n x 3, in the input's order)
// that plain formulas give. In single precision forces still cancel over the body to double round-off.
void expect_agreement(const Material& material, const Model& model, const Positions& x, int variant, double expected,
                      const Positions& force) {
  struct Kernel {
    decltype(ElementKernels::elements) elements;
    double of_energy, of_force;  // allowed differences, over the sums
  };
  const ElementKernels& kernels = element_kernels(variant);
  for (const Kernel& kernel : {Kernel{kernels.elements, 1e-12, 1e-11}, Kernel{kernels.elements_single, 5e-6, 2e-5}}) {
    double energy = 0;
    Positions found = Positions::Zero(model.vertices, 3);
    for (std::size_t c = 0; c < model.chunks.size(); ++c) {
      const ElementChunk chunk = model.chunk(static_cast<int>(c));
      AlignedVector<double> values(chunk.blocks * block_width), local(chunk.vertices * list_stride),
          list_force(chunk.vertices * list_stride);
      energy += kernel.elements(chunk, x.data(), nullptr, values.data(), list_force.data(), local.data());
      for (int i = 0; i < chunk.vertices; ++i) {
        for (int k = 0; k < 3; ++k) found(model.input_of[chunk.vertex[i]], k) += list_force[list_stride * i + k];
      }
    }
    EXPECT_NEAR(energy / expected, 1, kernel.of_energy) << name_of(material) << " by " << variant_name(variant);
    EXPECT_LT((found - force).norm(), kernel.of_force * force.norm())
        << name_of(material) << " by " << variant_name(variant);
    EXPECT_LT(found.colwise().sum().norm(), 1e-12 * force.norm()) << name_of(material);
  }
}

TEST(Kernels, EveryVariantAgreesWithThePlainFormulas) {
  for (const Material& material : all_materials()) {
    const Model model = build_model(test::bar(material, test::Held::nothing, Precision::double_precision, 2));
    const Positions x = test::shaken(model.rest, 0.04, 3);  // inverts some elements
    // The plain path evaluates one element after the other.
    double expected = 0;
    Positions force = Positions::Zero(model.vertices, 3);
    const TetMesh mesh = test::bar(material, test::Held::nothing, Precision::double_precision, 2).mesh;
    const Positions in_order = in_input_order(model, x);
    for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
      Mat3 rest, now, stress;
      for (int k = 0; k < 3; ++k) {
        rest.col(k) = (mesh.rest.row(mesh.tets(e, k + 1)) - mesh.rest.row(mesh.tets(e, 0))).transpose();
        now.col(k) = (in_order.row(mesh.tets(e, k + 1)) - in_order.row(mesh.tets(e, 0))).transpose();
      }
      const Mat3 inverse = rest.inverse();
      const double volume = rest.determinant() / 6;
      expected += volume * density(material, now * inverse, &stress);
      const Mat3 gradient = volume * stress * inverse.transpose();
      for (int k = 0; k < 3; ++k) {
        force.row(mesh.tets(e, k + 1)) += gradient.col(k).transpose();
        force.row(mesh.tets(e, 0)) -= gradient.col(k).transpose();
      }
    }
    for (int v = 0; v < runnable_variants(); ++v) expect_agreement(material, model, x, v, expected, force);
  }
}

}  // namespace material_test
}  // namespace supple
