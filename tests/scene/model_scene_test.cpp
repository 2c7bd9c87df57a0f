// Tests what is chosen for a model that is filmed without a scene: which way it stands, and how stiff it is.
#include "scene/reading/model_scene.h"
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/tetrahedra/tetrahedralize.h"
#include "scene/reading/sagging.h"
#include "scene/reading/upright.h"
#include "support/surfaces.h"

namespace supple {
namespace model_scene_test {

using test::box_surface;
using test::inside_out;
using test::moved;
using test::together;

// A table whose top lies above four legs along an axis, as tall as it is wide.
TriMesh table_along(UpAxis up) {
  TriMesh table = moved(box_surface({0.5, 0.1, 0.5}), {0, 0.9, 0});
  for (const double x : {-0.4, 0.4})
    for (const double z : {-0.4, 0.4}) table = together(table, moved(box_surface({0.05, 0.45, 0.05}), {x, 0.4, z}));
  if (up == UpAxis::z) {
    Positions turned = table.points;
    turned.col(1) = -table.points.col(2);
    turned.col(2) = table.points.col(1);
    table.points = turned;
  }
  return table;
}

TEST(Upright, IsYUnlessTheModelTellsOtherwise) {
  EXPECT_EQ(guess_upright("a.obj", table_along(UpAxis::y)).up, UpAxis::y);
  EXPECT_EQ(guess_upright("a.obj", table_along(UpAxis::y)).reason, "");
  EXPECT_EQ(guess_upright("a.obj", box_surface({0.5, 0.5, 0.6})).up, UpAxis::y) << "hardly taller";
}

TEST(Upright, IsTheAxisAlongWhichTheModelIsFarTallerAndStands) {
  // A statue that lies on its round back.
  TriMesh statue = test::sphere_surface(1, 24, 12);
  for (Eigen::Index v = 0; v < statue.points.rows(); ++v) {
    const Vec3 p = statue.points.row(v);
    statue.points.row(v) << p.x(), p.z(), 3 * std::clamp(p.y(), -0.7, 0.7);
  }
  EXPECT_EQ(guess_upright("a.obj", inside_out(statue)).up, UpAxis::z);
  EXPECT_NE(guess_upright("a.obj", inside_out(statue)).reason.find("times as long along it as across"),
            std::string::npos);
  // A box such as a bus stands on its longest side as well as on its end.
  EXPECT_EQ(guess_upright("a.obj", box_surface({0.2, 0.2, 0.9})).up, UpAxis::y);
  // A long body that stands on feet across its length is no tower: its end is a tip.
  TriMesh fish = box_surface({0.2, 0.2, 0.9});
  for (Eigen::Index v = 0; v < fish.points.rows(); ++v)
    if (fish.points(v, 2) < 0) fish.points.row(v).head(2) << 0.3 + 0.01 * fish.points(v, 0), 0.01 * fish.points(v, 1);
  EXPECT_EQ(guess_upright("a.obj", fish).up, UpAxis::y);
}

TEST(Upright, IsZInFilesOfPrintersUnlessTheModelWouldTopple) {
  EXPECT_EQ(guess_upright("a.stl", box_surface({0.5, 0.5, 0.5})).up, UpAxis::z);
  EXPECT_EQ(guess_upright("A.STL", table_along(UpAxis::z)).up, UpAxis::z);
  EXPECT_EQ(guess_upright("a.glb", table_along(UpAxis::z)).up, UpAxis::y) << "the format says so";
}

TEST(Upright, IsTheAxisOnWhichItStandsWhereItWouldToppleOnTheUsualOne) {
  TriMesh pyramid = box_surface({1, 1, 1});  // its tip lies along z
  for (Eigen::Index v = 0; v < pyramid.points.rows(); ++v)
    if (pyramid.points(v, 2) > 0) pyramid.points.row(v).head(2) *= 0.01;
  EXPECT_LT(steadiness(pyramid, UpAxis::y), 0);
  const Upright found = guess_upright("a.ply", pyramid);
  EXPECT_EQ(found.up, UpAxis::z);
  EXPECT_NE(found.reason.find("would topple with y up"), std::string::npos) << found.reason;
  // A foot below its middle keeps it from toppling until the first jolt.
  const TriMesh wobbly = together(pyramid, moved(box_surface({0.05, 0.05, 0.05}), {0, -0.95, -0.52}));
  EXPECT_GT(steadiness(wobbly, UpAxis::y), 0);
  EXPECT_LT(steadiness(wobbly, UpAxis::y), 0.03);
  EXPECT_EQ(guess_upright("a.ply", wobbly).up, UpAxis::z);
}

TEST(ModelScene, TellsNothingThatSettingsMakeUntrue) {
  const ModelScene scene{
      "", {{"long", {"body.model.size"}}, {"soft", {"body.model.material"}}, {"held", {"body.model.handles"}}}};
  using Lines = std::vector<std::string>;
  EXPECT_EQ(scene.notes_with({}), (Lines{"long", "soft", "held"}));
  EXPECT_EQ(scene.notes_with({"look.labels=true"}), (Lines{"long", "soft", "held"}));
  EXPECT_EQ(scene.notes_with({"body.model.size=2"}), (Lines{"soft", "held"}));
  EXPECT_EQ(scene.notes_with({"body.model.material.young=1e5", "body.model.handles=[]"}), (Lines{"long"}));
}

TEST(ModelScene, TakesItsSizeAndAxisFromSettings) {
  for (const char* wrong : {"look.labels=true", "body.model.size=big", "body.model.size=-1", "body.model.size=1e300",
                            "body.model.size=inf", "body.model.up=w", "body.model.sizes=2"}) {
    const ModelWish none = wish_of({wrong});
    EXPECT_FALSE(none.up) << wrong;
    EXPECT_EQ(none.size, 0.5) << wrong;
  }
  const ModelWish wish = wish_of({"body.model.size=2", "body.model.size=1_0", "body.model.up=\"-y\""});
  EXPECT_EQ(wish.up, UpAxis::minus_y);
  EXPECT_EQ(wish.size, 10);
  EXPECT_EQ(wish_of({"body.model.up='z'"}).up, UpAxis::z);
  EXPECT_EQ(wish_of({"body.model.up=-x"}).up, UpAxis::minus_x);
}

TEST(Sagging, OfAColumnIsThatOfItsWeight) {
  const TetMesh column = box_mesh({0.2, 0.5, 0.2}, {4, 10, 4});
  const Sagging wanted{1000, 0.3, 0.05, 0.03};
  const double young = young_for_sag(column, wanted);
  EXPECT_NEAR(sag_of(column, wanted, young), 0.05, 0.01);
  EXPECT_NEAR(young, 1000 * 9.81 * 0.5 / (2 * 0.05), 0.5 * young) << "a column sags by rho g h^2 / 2 E";
  Sagging heavy = wanted;
  heavy.density = 3000;
  EXPECT_NEAR(young_for_sag(column, heavy), 3 * young, 0.5 * young);
}

// A block on a thin stem. aside: of the stem from the block's middle, along x [m].
TetMesh lamp_on_stem(double aside) {
  TetMesh lamp = box_mesh({0.3, 0.5, 0.3}, {6, 10, 6});
  for (Eigen::Index v = 0; v < lamp.rest.rows(); ++v) {
    if (lamp.rest(v, 1) > 0.36) continue;
    for (const int k : {0, 2}) lamp.rest(v, k) = 0.15 + 0.15 * (lamp.rest(v, k) - 0.15);
    lamp.rest(v, 0) += aside;
  }
  return lamp;
}

TEST(Sagging, KeepsThinLegsFromBuckling) {
  const TetMesh lamp = lamp_on_stem(0);  // pressed by 5 % alone, the stem would buckle
  const Sagging wanted{1000, 0.4, 0.05, 0.03};
  const double young = young_for_sag(lamp, wanted);
  EXPECT_LT(sag_of(lamp, wanted, young), 0.08);
  EXPECT_GT(sag_of(lamp, wanted, young), 0.02);
  EXPECT_GT(young, 5 * 1000 * 9.81 * 0.5 / (2 * 0.05)) << "the stem carries more than a column does";
}

TEST(Sagging, DoesNotDependOnTheWayInWhichABodyLeans) {
  const TetMesh lamp = lamp_on_stem(0.02);
  TetMesh turned = lamp;  // by half a turn about y
  for (const int k : {0, 2}) turned.rest.col(k) *= -1;
  const Sagging wanted{1000, 0.4, 0.05, 0.03};
  const double young = young_for_sag(lamp, wanted), other = young_for_sag(turned, wanted);
  EXPECT_NEAR(other, young, 0.01 * young);
  EXPECT_NEAR(young_for_fall(turned, wanted, other, 0.05), young_for_fall(lamp, wanted, young, 0.05), 0.01 * young);
}

}  // namespace model_scene_test
}  // namespace supple
