// Tests the quantities of elements that pictures show, against closed forms and against the fields of a model.
#include "sim/measures/pose_elements.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/meshes/mesh.h"
#include "sim/measures/fields.h"
#include "support/bodies.h"
#include "support/deformations.h"

namespace supple {
namespace pose_elements_test {

std::vector<double> evaluated(const BodyDescription& body, ElementQuantity quantity, const Positions& x,
                              Threads* threads = nullptr) {
  std::vector<double> values;
  PoseElements(body).evaluate(quantity, x, threads, values);
  return values;
}

TEST(PoseElements, GiveTheStretchesOfADeformation) {
  std::mt19937 random(4);
  const BodyDescription body = test::bar(NeoHookean{1e4, 2e4}, test::Held::nothing);
  for (const test::Kind& kind : test::kinds) {
    const Vec3 s = kind.stretches(random);
    const Mat3 f = test::random_rotation(random) * s.asDiagonal() * test::random_rotation(random);
    const Positions x = body.mesh.rest * f.transpose();
    const double flip = s.prod() < 0 ? -1 : 1, least = flip * s.cwiseAbs().minCoeff();
    const double most = s.cwiseAbs().maxCoeff();
    for (const double value : evaluated(body, ElementQuantity::stretch, x)) EXPECT_NEAR(value, most, 1e-9 * most);
    for (const double value : evaluated(body, ElementQuantity::compression, x))
      EXPECT_NEAR(value, 1 - least, 1e-9 * most) << kind.name;
    for (const double value : evaluated(body, ElementQuantity::volume_ratio, x))
      EXPECT_NEAR(value, s.prod(), 1e-9 * most * most * most) << kind.name;
  }
}

TEST(PoseElements, AreTheFieldsOfTheModel) {
  for (const Material& material : test::all_materials()) {
    BodyDescription body = test::bar(material, test::Held::hard_end);
    body.fibres.assign(body.materials.size(), Fibre{3e3, {0, 0.6, 0.8}});
    const Model model = build_model(body);
    const Positions x = test::shaken(body.mesh.rest, 0.02, 5);
    Positions in_model(x.rows(), 3);
    for (int v = 0; v < model.vertices; ++v) in_model.row(v) = x.row(model.input_of[v]);
    const ElementFields fields = element_fields(model, in_model);
    const std::vector<double> energy = evaluated(body, ElementQuantity::energy, x);
    const std::vector<double> stress = evaluated(body, ElementQuantity::von_mises, x);
    ASSERT_EQ(energy.size(), fields.energy.size());
    for (std::size_t e = 0; e < energy.size(); ++e) {
      EXPECT_NEAR(energy[e], fields.energy[e], 1e-9 * std::abs(fields.energy[e])) << name_of(material);
      EXPECT_NEAR(stress[e], fields.von_mises[e], 1e-9 * std::abs(fields.von_mises[e])) << name_of(material);
    }
  }
}

TEST(PoseElements, AreTheSameForAnyNumberOfThreads) {
  const BodyDescription body =
      test::bar(StableNeoHookean{1e4, 2e4}, test::Held::nothing, Precision::double_precision, 8);
  ASSERT_GT(body.mesh.tets.rows(), 2048) << "too few elements for several chunks";
  const Positions x = test::shaken(body.mesh.rest, 0.004, 6);
  Threads threads(3);
  const PoseElements elements(body);
  std::vector<double> alone, shared, alone_by_vertex, shared_by_vertex;
  elements.evaluate(ElementQuantity::von_mises, x, nullptr, alone);
  elements.evaluate(ElementQuantity::von_mises, x, &threads, shared);
  EXPECT_EQ(alone, shared);
  elements.to_vertices(alone, nullptr, alone_by_vertex);
  elements.to_vertices(alone, &threads, shared_by_vertex);
  EXPECT_EQ(alone_by_vertex, shared_by_vertex);
}

TEST(PoseElements, GoToVerticesByTheVolumesOfTheirElements) {
  // Two elements with a common face; the second is three times as high as the first, and so three times as large.
  BodyDescription body;
  body.mesh.rest.resize(5, 3);
  body.mesh.rest << 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, -3, 0;
  body.mesh.tets.resize(2, 4);
  body.mesh.tets << 0, 2, 1, 3, 0, 1, 2, 4;
  body.materials = {NeoHookean{1, 1}};
  const PoseElements elements(body);
  std::vector<double> by_vertex;
  elements.to_vertices({4, 8}, nullptr, by_vertex);
  const std::vector<double> expected = {7, 7, 7, 4, 8};
  ASSERT_EQ(by_vertex.size(), expected.size());
  for (std::size_t v = 0; v < expected.size(); ++v) EXPECT_NEAR(by_vertex[v], expected[v], 1e-12);
  const double undefined = std::numeric_limits<double>::quiet_NaN();
  elements.to_vertices({undefined, 8}, nullptr, by_vertex);
  EXPECT_NEAR(by_vertex[0], 8, 1e-12);
  EXPECT_TRUE(std::isnan(by_vertex[3]));
}

TEST(PoseElements, HaveNoStressWhereTheVolumeIsGone) {
  const BodyDescription body = test::bar(StableNeoHookean{1e4, 2e4}, test::Held::nothing);
  Positions flat = body.mesh.rest;
  flat.col(1).setZero();
  for (const double value : evaluated(body, ElementQuantity::von_mises, flat)) EXPECT_TRUE(std::isnan(value));
  for (const double value : evaluated(body, ElementQuantity::compression, flat)) EXPECT_NEAR(value, 1, 1e-12);
}

}  // namespace pose_elements_test
}  // namespace supple
