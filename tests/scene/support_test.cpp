// Tests what is seen where handles hold bodies.
#include "scene/building/support.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "scene/building/assemble.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"

namespace supple {
namespace support_test {

const std::string bar =
    "box = { extent = [2, 0.2, 0.2], cells = [20, 2, 2] }\nposition = [0, 1, 0]\nmaterial = \"rubber\"\n";
const std::string cloth = "cloth = { extent = [1, 1], cells = [10, 10], stretch = 100 }\nposition = [0, 1, 0]\n";

std::string handle(const std::string& name, const std::string& select) {
  return "[[body.handles]]\nname = \"" + name + "\"\nselect = " + select + "\n";
}

Body body_of(const std::string& keys) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << "[[body]]\n" << keys;
  return assemble(load_scene(folder.path / "s.toml", test::assets, {})).front();
}

std::vector<Bounds> boxes_of(const Body& body) {
  std::vector<Bounds> boxes;
  for (const Support& one : supports_of(body)) boxes.push_back(bounds_of(one.surface.points));
  return boxes;
}

TEST(Support, AHeldFaceHasAPlateThatLeavesTheRestOfTheBodyFree) {
  const std::vector<Bounds> plates = boxes_of(body_of(bar + handle("end", "{ box = [[1, 0, 0], [1, 1, 1]] }")));
  ASSERT_EQ(plates.size(), 1u);
  EXPECT_GT(plates[0].upper.x(), 1.0);
  EXPECT_LT(plates[0].upper.x(), 1.1);
  EXPECT_GT(plates[0].lower.x(), 0.95) << "it hides half a cell at most";
  EXPECT_LT(plates[0].lower.x(), 1.0) << "no seam is seen";
  EXPECT_LT(plates[0].lower.y(), 1.0);
  EXPECT_GT(plates[0].upper.y(), 1.2);
  EXPECT_LT(plates[0].extent().y(), 0.3);
}

TEST(Support, TheEndOfATurnedBodyHasItsPlateThere) {
  const std::vector<Bounds> plates =
      boxes_of(body_of(bar + "turn_deg = [0, 0, 90]\n" + handle("end", "{ box = [[0.9, 0, 0], [1, 1, 1]] }")));
  ASSERT_EQ(plates.size(), 1u);
  EXPECT_GT(plates[0].upper.y(), 3.0);
  EXPECT_GT(plates[0].lower.y(), 2.9);
  EXPECT_LT(plates[0].extent().x(), 0.3);
}

TEST(Support, ASliceHasARingAroundIt) {
  const std::vector<Bounds> rings = boxes_of(body_of(bar + handle("middle", "{ box = [[0.44, 0, 0], [0.56, 1, 1]] }")));
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_NEAR(rings[0].center().x(), 0, 1e-9);
  EXPECT_NEAR(rings[0].extent().x(), 0.2, 1e-9);  // three layers of vertices
  EXPECT_LT(rings[0].lower.z(), -0.1);
  EXPECT_GT(rings[0].upper.z(), 0.1);
}

TEST(Support, CornersOfClothHavePinsAndEdgesRods) {
  const std::vector<Bounds> pins = boxes_of(body_of(cloth + handle("left", "{ box = [[0, 1, 0], [0, 1, 1]] }") +
                                                    handle("right", "{ box = [[1, 1, 0], [1, 1, 1]] }")));
  ASSERT_EQ(pins.size(), 2u);
  EXPECT_LT((pins[0].center() - Vec3(-0.5, 2, 0)).norm(), 1e-9);
  EXPECT_LT((pins[1].center() - Vec3(0.5, 2, 0)).norm(), 1e-9);
  EXPECT_LT(pins[0].diagonal(), 0.08);

  const std::vector<Bounds> rods = boxes_of(body_of(cloth + handle("top", "{ box = [[0, 1, 0], [1, 1, 1]] }")));
  ASSERT_EQ(rods.size(), 1u);
  EXPECT_LT((rods[0].center() - Vec3(0, 2, 0)).norm(), 1e-9);
  EXPECT_GT(rods[0].extent().x(), 1.0);
  EXPECT_LT(rods[0].extent().y(), 0.04);

  const std::vector<Bounds> clamps = boxes_of(body_of(cloth + handle("strip", "{ box = [[0, 0.9, 0], [1, 1, 1]] }")));
  ASSERT_EQ(clamps.size(), 1u);
  EXPECT_LT(clamps[0].lower.z(), 0);
  EXPECT_GT(clamps[0].upper.z(), 0);
  EXPECT_LT(clamps[0].lower.y(), 1.9);
}

TEST(Support, ARimOfClothHasPinsBecauseAClampWouldHideTheCloth) {
  Body rim = body_of(cloth + handle("lower", "{ box = [[0, 0, 0], [1, 0, 1]] }"));
  rim.def.handles.emplace_back().name = "rim";
  rim.description.handles.push_back({"rim", {}});
  for (std::int32_t v = 0; v < 121; ++v) {  // three sides of the grid
    if (v % 11 == 0 || v % 11 == 10 || v / 11 == 10) rim.description.handles[1].vertices.push_back(v);
  }
  const std::vector<Support> supports = supports_of(rim);
  ASSERT_GT(supports.size(), 2u);
  for (const Support& one : supports) {
    if (one.handle == 1) {
      EXPECT_LT(bounds_of(one.surface.points).diagonal(), 0.08);
    }
  }
}

TEST(Support, WhatSomethingElseCarriesHasNone) {
  Body rim = body_of(cloth + handle("lower", "{ box = [[0, 0, 0], [1, 0, 1]] }"));
  ASSERT_FALSE(supports_of(rim).empty());
  rim.def.handles.front().attach = AttachDef{"hand", "", {}};
  EXPECT_TRUE(supports_of(rim).empty());
}

TEST(Support, ASmallPartOfAFigureHasAPinThatStandsOutOfItsSkin) {
  const Body ball = body_of(
      "shape = \"shapes/sphere.toml\"\nvertices = 2000\nsize = 1\nposition = [0, 1, 0]\n"
      "material = \"jelly\"\n" +
      handle("fingers", "{ sphere = { center = [0.9, 0.8, 0.5], radius = 0.07 } }"));
  const std::vector<Bounds> pins = boxes_of(ball);
  ASSERT_EQ(pins.size(), 1u);
  const double radius = 0.5 * pins[0].extent().x();
  EXPECT_LT((pins[0].center() - Vec3(0.4, 1.8, 0)).norm(), 0.1);
  EXPECT_GT((pins[0].center() - Vec3(0, 1.5, 0)).norm() + radius, 0.51);
  EXPECT_LT(radius, 0.06);
}

TEST(Support, NothingIsSeenOfWhatHoldsNothingOrOnlyTheInside) {
  EXPECT_TRUE(supports_of(body_of(bar)).empty());
  EXPECT_TRUE(supports_of(body_of(bar + handle("inner", "{ box = [[0.1, 0.4, 0.4], [0.9, 0.6, 0.6]] }"))).empty());
}

TEST(Support, ThePlateOfABodyThatStandsLiesInTheGround) {
  const std::string foot = handle("foot", "{ box = [[0, 0, 0], [1, 0, 1]] }");
  const std::vector<Bounds> standing =
      boxes_of(body_of("box = { extent = [1, 1, 1], cells = [4, 4, 4] }\nmaterial = \"jelly\"\n" + foot));
  ASSERT_EQ(standing.size(), 1u);
  EXPECT_LT(standing[0].upper.y(), 0);
  const std::vector<Bounds> hanging = boxes_of(body_of(
      "box = { extent = [1, 1, 1], cells = [4, 4, 4] }\nposition = [0, 0.5, 0]\nmaterial = \"jelly\"\n" + foot));
  ASSERT_EQ(hanging.size(), 1u);
  EXPECT_GT(hanging[0].upper.y(), 0.5);
}

TEST(Support, GoesAlongWithWhatIsHeld) {
  const Body body = body_of(bar + handle("end", "{ box = [[1, 0, 0], [1, 1, 1]] }") +
                            "keys = [{ t = 0 }, { t = 1, move = [0.1, 0.2, -0.3], turn_deg = [10, 20, 150] }]\n");
  const Eigen::Isometry3d wanted = body.motions[0].at(1);
  Positions now = body.description.mesh.rest;
  for (const std::int32_t v : body.description.handles[0].vertices)
    now.row(v) = (wanted * Vec3(now.row(v))).transpose();
  EXPECT_LT((motion_of_held(body, 0, now).matrix() - wanted.matrix()).norm(), 1e-12);
}

TEST(Support, TheKeyTakesTrueAndFalseAlone) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << "[[body]]\n" << bar << "[look]\nsupports = false\n";
  EXPECT_FALSE(load_scene(folder.path / "s.toml", test::assets, {}).look.supports);
  EXPECT_TRUE(load_scene(folder.path / "s.toml", test::assets, {"look.supports=true"}).look.supports);
  try {
    load_scene(folder.path / "s.toml", test::assets, {"look.supports=some"});
    FAIL() << "it was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("supports = 'some': must be true or false"), std::string::npos)
        << error.what();
  }
}

}  // namespace support_test
}  // namespace supple
