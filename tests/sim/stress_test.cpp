// Tests the stress of every material against formulas that are written a second time: a', b' and c' of the
// Valanis-Landel form as they follow from the energies in docs/method.md, and principal stretches in closed form. It
// also tests k of equation 11.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <fstream>
#include <functional>
#include <set>

#include "sim/elements/tetrahedron.h"
#include "support/bodies.h"
#include "support/places.h"

namespace supple {
namespace stress_test {

using Function = std::function<double(double)>;

double nothing(double) { return 0; }

// Holds the derivatives of a, b and c, and of a term d(I_C) that is no sum over stretches.
struct Curves {
  Material material;
  Function a, b, c;
  Function d = nothing;
};

// Returns c' = (lambda log J - linear) / J, continued as a straight line below J = 0.1.
Function log_volume(double linear, double lambda) {
  return [=](double j) {
    const double at = std::max(j, 0.1);
    const double slope = (lambda * std::log(at) - linear) / at;
    return slope + (j < 0.1 ? (lambda + linear - lambda * std::log(0.1)) / 0.01 * (j - 0.1) : 0.0);
  };
}

// Computes the natural cubic spline a second time: a dense system for its second derivatives, and the symmetric formula
// (de Boor 2001, "A practical guide to splines", chapter IV).
Function natural_spline(const std::vector<ControlPoint>& p) {
  const auto n = static_cast<Eigen::Index>(p.size());
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const double before = p[i].at - p[i - 1].at, after = p[i + 1].at - p[i].at;
    system(i, i - 1) = before / 6;
    system(i, i) = (before + after) / 3;
    system(i, i + 1) = after / 6;
    right[i] = (p[i + 1].value - p[i].value) / after - (p[i].value - p[i - 1].value) / before;
  }
  const Eigen::VectorXd m = system.lu().solve(right);
  return [p, m, n](double x) {
    const double first = p[1].at - p[0].at, last = p[n - 1].at - p[n - 2].at;
    if (x < p[0].at) return p[0].value + (x - p[0].at) * ((p[1].value - p[0].value) / first - first * m[1] / 6);
    if (x >= p[n - 1].at)
      return p[n - 1].value + (x - p[n - 1].at) * ((p[n - 1].value - p[n - 2].value) / last + last * m[n - 2] / 6);
    Eigen::Index i = 0;
    while (x >= p[i + 1].at) ++i;
    const double h = p[i + 1].at - p[i].at, right_part = (x - p[i].at) / h, left_part = 1 - right_part;
    return left_part * p[i].value + right_part * p[i + 1].value +
           h * h / 6 *
               ((std::pow(left_part, 3) - left_part) * m[i] + (std::pow(right_part, 3) - right_part) * m[i + 1]);
  };
}

std::vector<Curves> all_curves() {
  const double mu = 3, lambda = 5;
  const auto clamped = [](double s, double low, double high) { return s - std::clamp(s, low, high); };
  const Spline a = Spline::preset_a({mu, lambda}), b = Spline::preset_b({mu, lambda});
  const Spline drawn{SplineCurve({{0.3, -4}, {0.8, -1}, {1, 0}, {1.5, 3}}), SplineCurve({{0.5, -1}, {1, 0}, {2, 2}}),
                     SplineCurve({{0.2, -3}, {1, 0}, {3, 4}})};
  return {
      {AsRigidAsPossible{mu}, [=](double s) { return 2 * mu * (s - 1); }, nothing, nothing},
      {Polynomial{mu}, [=](double s) { return 4 * mu * std::pow(s - 1, 3); }, nothing, nothing},
      {Corotated{mu, lambda}, [=](double s) { return 2 * mu * (s - 1) + lambda * (s - 3); },
       [=](double) { return lambda; }, nothing},
      {StVenantKirchhoff{mu, lambda}, [=](double s) { return mu * s * (s * s - 1) + lambda / 2 * (s * s * s - 3 * s); },
       [=](double s) { return lambda / 2 * s; }, nothing},
      {NeoHookean{mu, lambda}, [=](double s) { return mu * s; }, nothing, log_volume(mu, lambda)},
      {MooneyRivlin{2, 1, lambda}, [](double s) { return 2 * s; }, [](double s) { return s; }, log_volume(4, lambda)},
      {FixedCorotated{mu, lambda}, [=](double s) { return 2 * mu * (s - 1); }, nothing,
       [=](double j) { return lambda * (j - 1); }},
      {StableNeoHookean{mu, lambda}, [=](double s) { return mu * s; }, nothing,
       [=](double j) { return -0.75 * mu + lambda * (j - 1); }, [=](double i) { return -mu / (2 * i + 2); }},
      {a, natural_spline(a.a.points()), nothing, natural_spline(a.c.points())},
      {b, natural_spline(b.a.points()), nothing, natural_spline(b.c.points())},
      {drawn, natural_spline(drawn.a.points()), natural_spline(drawn.b.points()), natural_spline(drawn.c.points())},
      {StrainLimiting{mu, 0.84, 1.16, 2, 0.65, 1.35},
       [=](double s) { return 2 * mu * clamped(s, 0.84, 1.16) + 4 * clamped(s, 0.65, 1.35); }, nothing, nothing},
  };
}

Mat3 stress_at(const Material& material, const Mat3& f) {
  Matrix3<double> m, p;
  for (int i = 0; i < 9; ++i) m.m[i] = f(i / 3, i % 3);
  std::visit([&](const auto& law) { (void)density_of(law, m, p); }, material);
  Mat3 stress;
  for (int i = 0; i < 9; ++i) stress(i / 3, i % 3) = p.m[i];
  return stress;
}

TEST(Stress, UniaxialTensionAndCompressionFollowTheClosedForms) {
  std::set<std::size_t> seen;
  for (const Curves& curves : all_curves()) {
    seen.insert(curves.material.index());
    for (double s = 0.05; s < 3; s += 0.05) {
      // For F = diag(s, 1, 1), the stress along is a'(s) + 2 b'(s) + c'(s), and the stress across is a'(1) + b'(1) + s
      // b'(s) + s c'(s); d(I_C) adds 2 d' F.
      const double of_norm = 2 * curves.d(s * s + 2);
      const double along = curves.a(s) + 2 * curves.b(s) + curves.c(s) + s * of_norm;
      const double across = curves.a(1) + curves.b(1) + s * curves.b(s) + s * curves.c(s) + of_norm;
      const double scale = std::abs(curves.a(s)) + std::abs(2 * curves.b(s)) + std::abs(curves.c(s)) + 1;
      const Mat3 stress = stress_at(curves.material, Vec3(s, 1, 1).asDiagonal());
      EXPECT_NEAR(stress(0, 0), along, 1e-8 * scale) << name_of(curves.material) << " at " << s;
      EXPECT_NEAR(stress(1, 1), across, 1e-8 * scale) << name_of(curves.material) << " at " << s;
      EXPECT_NEAR(std::visit([s](const auto& m) { return m.axial_stress(s); }, curves.material), along, 1e-8 * scale);
    }
  }
  EXPECT_EQ(seen.size(), std::variant_size_v<Material>) << "a material without closed forms";
}

TEST(Stress, SidesThatAreFreeCarryNoStressAtTheStretchThatTheClosedFormSays) {
  // This is uniaxial tension proper: bisection finds the stretch t of the sides where a'(t) + s b'(s t) + t b'(t^2) + s
  // t c'(s t^2) = 0.
  for (const Curves& curves : all_curves()) {
    if (std::holds_alternative<Spline>(curves.material) || std::holds_alternative<StrainLimiting>(curves.material))
      continue;
    for (const double s : {0.8, 0.9, 1.1, 1.3, 1.6}) {
      const auto side = [&](double t) {
        return curves.a(t) + s * curves.b(s * t) + t * curves.b(t * t) + s * t * curves.c(s * t * t) +
               2 * t * curves.d(s * s + 2 * t * t);
      };
      double low = 0.6, high = 1.4;
      if (std::holds_alternative<Polynomial>(curves.material) || side(low) * side(high) > 0) continue;
      for (int step = 0; step < 100; ++step)
        (side(0.5 * (low + high)) * side(high) > 0 ? high : low) = 0.5 * (low + high);
      const Mat3 stress = stress_at(curves.material, Vec3(s, low, low).asDiagonal());
      EXPECT_NEAR(stress(1, 1), 0, 1e-8) << name_of(curves.material) << " at " << s;
      const double along = curves.a(s) + 2 * low * curves.b(s * low) + low * low * curves.c(s * low * low);
      EXPECT_NEAR(stress(0, 0), along + 2 * s * curves.d(s * s + 2 * low * low), 1e-8);
    }
  }
}

TEST(Stress, SimpleShearFollowsTheClosedForms) {
  for (const Curves& curves : all_curves()) {
    for (const double gamma : {-1.5, -0.4, 0.05, 0.3, 0.7, 1.0, 2.0}) {
      Mat3 f = Mat3::Identity();
      f(0, 1) = gamma;
      // The stretches are s and 1/s with s - 1/s = gamma, and 1, so the volume stays; dPsi/dgamma = P_12.
      const double s = std::abs(gamma) / 2 + std::sqrt(1 + gamma * gamma / 4), t = 1 / s;
      const double found = stress_at(curves.material, f)(0, 1);
      const double expected =
          std::copysign((s * (curves.a(s) + curves.b(s)) - t * (curves.a(t) + curves.b(t))) / (s + t), gamma) +
          2 * gamma * curves.d(3 + gamma * gamma);
      EXPECT_NEAR(found, expected, 1e-8 * (1 + std::abs(expected))) << name_of(curves.material) << " at " << gamma;
    }
  }
}

// Computes the exact integral of a function that is a polynomial of degree at most 5 between the seams (Boole's rule).
double integral_between_seams(const Function& f, std::vector<double> seams, double from, double to) {
  seams.push_back(from);
  seams.push_back(to);
  std::sort(seams.begin(), seams.end());
  double sum = 0;
  for (std::size_t i = 0; i + 1 < seams.size(); ++i) {
    const double low = std::clamp(seams[i], from, to), high = std::clamp(seams[i + 1], from, to), h = (high - low) / 4;
    sum += 2 * h / 45 * (7 * f(low) + 32 * f(low + h) + 12 * f(low + 2 * h) + 32 * f(low + 3 * h) + 7 * f(high));
  }
  return sum;
}

TEST(Stiffness, FollowsEquationElevenInClosedFormForEveryMaterial) {
  const double mu = 3, lambda = 5;
  const auto over = [](auto primitive) { return primitive(1.5) - primitive(0.5); };
  // These are 12 times the integrals of (s-1)(s - 1/s) and (s-1) log(s)/s over [1/2, 3/2].
  const double by_mu = 12 * over([](double s) { return s * s * s / 3 - s * s / 2 - s + std::log(s); });
  const double by_lambda = 12 * over([](double s) { return s * std::log(s) - s - std::log(s) * std::log(s) / 2; });
  const auto near = [](const Material& material, double expected) {
    EXPECT_NEAR(fitted_stiffness(material), expected, 1e-10 * expected) << name_of(material);
  };
  near(AsRigidAsPossible{mu}, 2 * mu);
  near(Polynomial{mu}, 0.6 * mu);
  near(Corotated{mu, lambda}, 2 * mu + lambda);
  near(StVenantKirchhoff{mu, lambda}, 2.15 * mu + 1.075 * lambda);
  near(NeoHookean{mu, 0}, mu * by_mu);
  near(NeoHookean{mu, lambda}, mu * by_mu + lambda * by_lambda);
  near(MooneyRivlin{2, 1, lambda}, 4 * by_mu + lambda * by_lambda);  // f = (mu_1 + 2 mu_2)(s - 1/s) + lambda log(s)/s
  near(FixedCorotated{mu, lambda}, 2 * mu + lambda);
  // 12 times the integral of (s-1) s/(s^2 + 3) over [1/2, 3/2]
  const double by_barrier =
      12 * over([](double s) { return s - std::log(s * s + 3) / 2 - std::sqrt(3) * std::atan(s / std::sqrt(3)); });
  near(StableNeoHookean{mu, lambda}, mu * (1 - by_barrier) + lambda);
  // Both sides of a limit contribute 12 * 2 * integral of e * 2 mu (e - e_1) from e_1 to 1/2.
  const auto limited = [](double m, double e) { return 48 * m * ((0.125 - e * e * e) / 3 - e * (0.25 - e * e) / 2); };
  near(StrainLimiting{mu, 0.84, 1.16, 2, 0.65, 1.35}, limited(mu, 0.16) + limited(2, 0.35));
  EXPECT_EQ(system_stiffness(StrainLimiting{mu, 0.84, 1.16, 2, 0.65, 1.35}).k, 2 * (mu + 2));
  for (const Curves& curves : all_curves()) {
    const auto* spline = std::get_if<Spline>(&curves.material);
    if (spline == nullptr) continue;
    const auto moment = [&](double s) { return (s - 1) * (curves.a(s) + 2 * curves.b(s) + curves.c(s)); };
    near(curves.material, 12 * integral_between_seams(moment, spline->seams(), 0.5, 1.5));
  }
}

TEST(Stiffness, HasAFloorUnderMaterialsThatSoften) {
  // The curve falls on both sides of rest, so the fit is negative, and M/h^2 + L would not be positive definite.
  const Spline falling{SplineCurve({{0.5, 2}, {1, 0}, {1.5, -2}}), {}, {}};
  EXPECT_LT(fitted_stiffness(falling), 0);
  const SystemStiffness floored = system_stiffness(falling);
  EXPECT_TRUE(floored.floored);
  EXPECT_GT(floored.k, 0);
  EXPECT_FALSE(system_stiffness(Polynomial{3}).floored);
  // Building succeeds only with a positive definite matrix.
  const Model model = build_model(test::bar(falling, test::Held::hard_end));
  EXPECT_TRUE(model.stiffness[0].floored);
}

TEST(Materials, SmallStrainsFollowYoungsModulusAndPoissonsRatio) {
  const double young = 1e5, poisson = 0.35, strain = 1e-6;
  const Lame lame = Lame::from_young(young, poisson);
  for (const Material& material : {Material(Corotated::from(lame)), Material(StVenantKirchhoff::from(lame)),
                                   Material(NeoHookean::from(lame)), Material(MooneyRivlin::from(lame)),
                                   Material(FixedCorotated::from(lame)), Material(StableNeoHookean::from(lame))}) {
    // When the sides contract by Poisson's ratio, the stress along is young * strain and the stress across is zero.
    const Mat3 stress = stress_at(material, Vec3(1 + strain, 1 - poisson * strain, 1 - poisson * strain).asDiagonal());
    EXPECT_NEAR(stress(0, 0) / (young * strain), 1, 1e-4) << name_of(material);
    EXPECT_NEAR(stress(1, 1) / (young * strain), 0, 1e-4) << name_of(material);
    Mat3 shear = Mat3::Identity();
    shear(0, 1) = strain;
    EXPECT_NEAR(stress_at(material, shear)(0, 1) / (lame.mu * strain), 1, 1e-4) << name_of(material);
  }
}

// Writes the curves of figure 6, for docs/stress-curves.svg.
TEST(Stress, CurvesAreWrittenForThePlot) {
  const Lame lame{1, 1};
  std::ofstream out(test::build_folder / "stress-curves.csv");
  out << "stretch,neo-hookean,spline A,spline B,polynomial,strain-limiting,corotated,st-venant-kirchhoff\n";
  const std::vector<Material> shown = {NeoHookean::from(lame),
                                       Spline::preset_a(lame),
                                       Spline::preset_b(lame),
                                       Polynomial{1},
                                       StrainLimiting{0.4, 0.84, 1.16, 0.7, 0.65, 1.35},
                                       Corotated::from(lame),
                                       StVenantKirchhoff::from(lame)};
  for (int i = 0; i <= 140; ++i) {
    const double s = 0.3 + 0.01 * i;
    out << s;
    for (const Material& material : shown)
      out << ',' << std::visit([s](const auto& m) { return m.axial_stress(s); }, material);
    out << '\n';
  }
  // Spline A resists compression more than Neo-Hookean does, and spline B resists tension more; on the other side
  // neither differs from it.
  const auto f = [&](int i, double s) {
    return std::visit([s](const auto& m) { return m.axial_stress(s); }, shown[i]);
  };
  EXPECT_LT(f(1, 0.5), f(0, 0.5) - 1);
  EXPECT_NEAR(f(2, 0.5), f(0, 0.5), 0.1);
  EXPECT_GT(f(2, 1.5), f(0, 1.5) + 1);
  EXPECT_NEAR(f(1, 1.5), f(0, 1.5), 0.1);
}

}  // namespace stress_test
}  // namespace supple
