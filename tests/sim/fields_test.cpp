// Tests fields against closed forms, and against the numbers that the solver itself uses.
#include "sim/measures/fields.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/measures/measures.h"
#include "support/bodies.h"

namespace supple {
namespace fields_test {

Positions mapped(const Positions& rest, const Mat3& f) { return rest * f.transpose(); }

TEST(Fields, StressOfAUniformlyStretchedBoxIsTheClosedForm) {
  // With stretches s along x and t across, sigma = diag(a, b, b) with Neo-Hookean's sigma_i = (mu (s_i^2 - 1) + lambda
  // log J) / J; von Mises' stress is |a - b|.
  const double mu = 1e4, lambda = 3e4;
  const Model model = build_model(test::bar(NeoHookean{mu, lambda}, test::Held::nothing));
  for (const auto& [s, t] : {std::pair(1.4, 0.9), {0.7, 1.1}, {1.0, 1.0}, {1.2, 1.2}}) {
    const ElementFields fields = element_fields(model, mapped(model.rest, Vec3(s, t, t).asDiagonal()));
    const double volume = s * t * t, a = (mu * (s * s - 1) + lambda * std::log(volume)) / volume,
                 b = (mu * (t * t - 1) + lambda * std::log(volume)) / volume;
    const double energy =
        0.5 * mu * (s * s + 2 * t * t - 3 - 2 * std::log(volume)) + 0.5 * lambda * std::log(volume) * std::log(volume);
    ASSERT_EQ(fields.von_mises.size(), std::size_t(model.elements));
    for (int e = 0; e < model.elements; ++e) {
      EXPECT_NEAR(fields.von_mises[e], std::abs(a - b), 1e-8 * mu);
      EXPECT_NEAR(fields.energy[e], energy, 1e-8 * mu);
      EXPECT_NEAR(fields.stretch(e, 0), std::max(s, t), 1e-12);
      EXPECT_NEAR(fields.stretch(e, 1), t, 1e-12);
      EXPECT_NEAR(fields.stretch(e, 2), std::min(s, t), 1e-12);
    }
  }
}

TEST(Fields, TurningABodyChangesNothingAndAMirrorShowsInTheSign) {
  const Model model = build_model(test::bar(StableNeoHookean{1e4, 3e4}, test::Held::nothing));
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Mat3 f = Vec3(1.3, 1.0, 0.8).asDiagonal();
  const ElementFields straight = element_fields(model, mapped(model.rest, f));
  const ElementFields turned = element_fields(model, mapped(model.rest, turn * f));
  const ElementFields mirrored = element_fields(model, mapped(model.rest, Vec3(1.3, 1.0, -0.8).asDiagonal()));
  for (int e = 0; e < model.elements; ++e) {
    EXPECT_NEAR(turned.von_mises[e], straight.von_mises[e], 1e-8 * straight.von_mises[e]);
    EXPECT_NEAR((turned.stretch - straight.stretch).row(e).norm(), 0, 1e-12);
    EXPECT_NEAR(mirrored.stretch(e, 2), -0.8, 1e-12);
  }
  const ElementFields flat = element_fields(model, mapped(model.rest, Vec3(1, 1, 0).asDiagonal()));
  EXPECT_TRUE(std::isnan(flat.von_mises[0]));
}

TEST(Fields, EnergiesAddUpToTheBodysForEveryMaterial) {
  for (const Material& material : test::all_materials()) {
    BodyDescription body = test::bar(material, test::Held::hard_end, Precision::double_precision, 2);
    body.fibres = {Fibre{5e3, {0.6, 0.8, 0}}};
    const Model model = build_model(body);
    const Positions x = test::shaken(model.rest, 0.01, 7);
    const ElementFields fields = element_fields(model, x);
    double sum = 0;
    for (Eigen::Index e = 0; e < body.mesh.tets.rows(); ++e) sum += tet_volume(body.mesh, e) * fields.energy[e];
    OpenWorkspace workspace;
    workspace.prepare(model, {});
    const double whole = elastic_energy(model, workspace, x);
    EXPECT_GT(whole, 0);
    EXPECT_NEAR(sum, whole, 1e-10 * whole) << name_of(material);
    EXPECT_TRUE(fields.spring_energy.empty());
  }
}

TEST(Fields, EnergiesOfSpringsAddUpToTheNets) {
  const Model model = build_model(test::spring_net(6));
  const Positions x = test::shaken(model.rest, 0.02, 3);
  const ElementFields fields = element_fields(model, x);
  EXPECT_EQ(fields.stretch.rows(), 0);
  double sum = 0;
  for (const double energy : fields.spring_energy) sum += energy;
  OpenWorkspace workspace;
  workspace.prepare(model, {});
  const double whole = elastic_energy(model, workspace, x);
  EXPECT_NEAR(sum, whole, 1e-12 * whole);
}

TEST(Fields, StretchesOfTrianglesAreThoseInTheirPlane) {
  Positions rest(3, 3);
  rest << 0, 0, 0, 1, 0, 0, 0.2, 0.7, 0;
  Triangles triangle(1, 3);
  triangle << 0, 1, 2;
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 1, 3).normalized()).toRotationMatrix();
  const auto at = [&](const Mat3& f) { return triangle_stretches(rest, mapped(rest, turn * f), triangle)[0]; };
  EXPECT_NEAR(at(Vec3(0.5, 2, 7).asDiagonal())[0], 2, 1e-12);
  EXPECT_NEAR(at(Vec3(0.5, 2, 7).asDiagonal())[1], 0.5, 1e-12);
  Mat3 shear = Mat3::Identity();
  shear(0, 1) = 0.6;  // stretches s and 1/s with s - 1/s = 0.6
  const double s = 0.3 + std::sqrt(1.09);
  EXPECT_NEAR(at(shear)[0], s, 1e-12);
  EXPECT_NEAR(at(shear)[1], 1 / s, 1e-12);
  EXPECT_TRUE(std::isnan(triangle_stretches(Positions::Zero(3, 3), rest, triangle)[0][0]));
}

}  // namespace fields_test
}  // namespace supple
