// Tests the SIMD singular value decomposition against the guarantees of its header, on ten million matrices of every
// kind.
#include "sim/elements/svd.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>
#include <xsimd/xsimd.hpp>

#include "base/types.h"

namespace supple {
namespace svd_test {

using V = xsimd::batch<double>;
constexpr int lanes = static_cast<int>(V::size);
constexpr double eps = 0x1p-52;

// Draws uniform numbers in [-1, 1) cheaply, because ten million matrices take nine of them each.
class Numbers {
 public:
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(static_cast<std::int64_t>(state_)) * 0x1p-63;
  }
  Mat3 rotation() { return Eigen::Quaterniond(next(), next(), next(), next() + 1e-3).normalized().toRotationMatrix(); }

 private:
  std::uint64_t state_ = 1;
};

struct MatrixKind {
  const char* name;
  Mat3 (*draw)(Numbers&);
};

Mat3 with(Numbers& n, double a, double b, double c) { return n.rotation() * Vec3(a, b, c).asDiagonal() * n.rotation(); }
double power(double exponent) { return std::pow(10.0, exponent); }

const MatrixKind kinds[] = {
    {"near rest", [](Numbers& n) { return with(n, 1 + 0.01 * n.next(), 1 + 0.01 * n.next(), 1 + 0.01 * n.next()); }},
    {"any entries",
     [](Numbers& n) {
       Mat3 f;
       for (double& x : f.reshaped()) x = n.next();
       return f;
     }},
    {"inverted", [](Numbers& n) { return with(n, 1 + 0.5 * n.next(), 1 + 0.5 * n.next(), -0.5 + 0.4 * n.next()); }},
    {"two equal", [](Numbers& n) { return with(n, 1, 1, n.next()); }},
    {"three equal", [](Numbers& n) { return with(n, 1, 1, 1); }},
    {"reflected", [](Numbers& n) { return with(n, 1, 1, -1); }},
    {"diagonal", [](Numbers& n) { return Mat3(Vec3(n.next(), n.next(), n.next()).asDiagonal()); }},
    {"rank 2", [](Numbers& n) { return with(n, 1, n.next(), 0); }},
    {"rank 1", [](Numbers& n) { return with(n, n.next(), 0, 0); }},
    {"rank 1, exactly",
     [](Numbers& n) { return Mat3(Vec3(n.next(), 0, n.next()) * Vec3(0, n.next(), n.next()).transpose()); }},
    {"rank 0", [](Numbers&) { return Mat3(Mat3::Zero()); }},
    {"small beside large", [](Numbers& n) { return with(n, 1, power(-8 + 8 * n.next()), power(-8 + 8 * n.next())); }},
    {"of any scale", [](Numbers& n) { return Mat3(with(n, 1, n.next(), n.next()) * power(300 * n.next())); }},
    {"badly scaled",
     [](Numbers& n) {
       Mat3 f;
       for (double& x : f.reshaped()) x = n.next() < -0.5 ? 0 : std::copysign(power(150 * n.next()), n.next());
       return f;
     }},
};

struct Worst {
  double residual = 0, orthogonality = 0, determinant = 0;
  void add(double& mine, double value) const { mine = value <= mine ? mine : value; }  // also keeps a NaN
};

void check(const Mat3& f, const Mat3& u, const Vec3& s, const Mat3& v, const char* name, Worst& worst) {
  const double largest = f.cwiseAbs().maxCoeff(), scale = largest > 0 ? largest : 1;
  const Mat3 scaled = f / scale;
  const double norm = largest > 0 ? scaled.norm() : 1;
  worst.add(worst.residual, (u * (s / scale).asDiagonal() * v.transpose() - scaled).norm() / norm);
  for (const Mat3* m : {&u, &v}) {
    worst.add(worst.orthogonality, (m->transpose() * *m - Mat3::Identity()).norm());
    worst.add(worst.determinant, std::abs(m->determinant() - 1));
  }
  const double slack = 32 * eps * s[0];
  ASSERT_TRUE(s[0] + slack >= s[1] && s[1] + slack >= std::abs(s[2])) << name << ": " << s.transpose() << "\n" << f;
}

TEST(Svd, IsAccurateForTenMillionMatricesOfEveryKind) {
  Numbers numbers;
  Worst worst;
  constexpr int matrices = 10'000'000, kind_count = static_cast<int>(std::size(kinds));
  for (int start = 0, turn = 0; start < matrices; start += lanes, ++turn) {
    const MatrixKind& kind = kinds[turn % kind_count];
    std::array<Mat3, lanes> f;
    alignas(64) double u[9][lanes], v[9][lanes], s[3][lanes];
    for (int lane = 0; lane < lanes; ++lane) {
      f[lane] = kind.draw(numbers);
      for (int i = 0; i < 9; ++i) u[i][lane] = f[lane](i / 3, i % 3);
    }
    Matrix3<V> wide;
    for (int i = 0; i < 9; ++i) wide.m[i] = V::load_aligned(u[i]);
    const Svd3<V> found = svd(wide);
    for (int i = 0; i < 9; ++i) {
      found.u.m[i].store_aligned(u[i]);
      found.v.m[i].store_aligned(v[i]);
    }
    for (int i = 0; i < 3; ++i) found.s[i].store_aligned(s[i]);
    for (int lane = 0; lane < lanes; ++lane) {
      Mat3 one_u, one_v;
      for (int i = 0; i < 9; ++i) {
        one_u(i / 3, i % 3) = u[i][lane];
        one_v(i / 3, i % 3) = v[i][lane];
      }
      check(f[lane], one_u, Vec3(s[0][lane], s[1][lane], s[2][lane]), one_v, kind.name, worst);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_LE(worst.residual, 32 * eps);
  EXPECT_LE(worst.orthogonality, 16 * eps);
  EXPECT_LE(worst.determinant, 16 * eps);
  RecordProperty("residual_in_eps", std::to_string(worst.residual / eps));
  std::cout << "worst, in eps: residual " << worst.residual / eps << ", orthogonality " << worst.orthogonality / eps
            << ", determinant " << worst.determinant / eps << '\n';
}

TEST(Svd, TheSmallestValueCarriesTheSignOfTheDeterminant) {
  Numbers numbers;
  for (int sample = 0; sample < 1000; ++sample) {
    const double smallest = 0.5 * numbers.next();
    const Mat3 f = with(numbers, 2, 1, smallest);
    Matrix3<double> m;
    for (int i = 0; i < 9; ++i) m.m[i] = f(i / 3, i % 3);
    const Svd3<double> found = svd(m);
    EXPECT_NEAR(found.s[0], 2, 1e-14);
    EXPECT_NEAR(found.s[1], 1, 1e-14);
    EXPECT_NEAR(found.s[2], smallest, 1e-14);
  }
}

}  // namespace svd_test
}  // namespace supple
