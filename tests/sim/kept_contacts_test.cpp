// Tests that cloth keeps its contacts from iterate to iterate where it hardly moves, and what is renewed of them then.
#include <gtest/gtest.h>

#include <algorithm>

#include "sim/solver/objective.h"
#include "sim/solver/place_iterate.h"
#include "support/contact_scene.h"

namespace supple {
namespace kept_contacts_test {

using test::shape_of;

const Collider ground{"ground", shape_of(HalfSpace{Vec3::UnitZ(), 0}), 0, 0.4};

// A sheet that slides on what is below it.
struct SheetOn : test::ContactScene {
  explicit SheetOn(const Collider& collider, double height = 0)
      : ContactScene(test::sheet({0.4, 0.3}, {12, 9}, {Woven{900, 700, 20, 0.05, 1.1}, 1e-4}), {collider},
                     Vec3(0, 0, height)) {
    inputs.gravity = Vec3(0, 0, -9.81);
  }
  void begin(const Vec3& velocity) {
    state.v.rowwise() = velocity.transpose();
    w.prepare(model, inputs.solver);
    begin_step(model, inputs, state, w);
  }
  void move(Iterate& iterate, const Vec3& way) const {
    iterate.x = state.x;
    iterate.x.topRows(model.free).rowwise() += way.transpose();
  }
};

TEST(KeptContacts, AreRenewedToWhatWouldBeFound) {
  SheetOn scene(ground);
  scene.begin(Vec3(0.3, 0.1, -0.1));
  const double way = 0.5 * scene.w.contact.kept_way;
  ASSERT_GT(way, 0);
  scene.move(scene.w.current, Vec3(0.01, 0, 0.3 * way));
  find_contacts_of(scene.model, scene.inputs, scene.w, scene.w.current);
  scene.move(scene.w.trial, Vec3(0.01 + 0.5 * way, 0, -0.4 * way));
  find_trial_contacts(scene.model, scene.inputs, scene.w);
  ASSERT_TRUE(scene.w.trial.keeps_contacts);

  std::vector<Contact> kept = scene.w.current.contacts;
  EXPECT_EQ(renew_contacts(scene.w.trial.x, kept), scene.model.free) << "all begin to touch";
  find_contacts_of(scene.model, scene.inputs, scene.w, scene.w.trial);
  const std::vector<Contact>& found = scene.w.trial.contacts;
  ASSERT_EQ(kept.size(), found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_GT(found[i].friction, 0);
    EXPECT_NEAR(kept[i].depth, found[i].depth, 1e-9 * found[i].depth);
    EXPECT_NEAR(kept[i].friction, found[i].friction, 1e-9 * found[i].friction);
  }
}

TEST(KeptContacts, AreFoundAnewAfterAllTheWaysSinceTheyWereFound) {
  SheetOn scene(ground);
  scene.begin(Vec3(0, 0, -0.1));
  const double most = scene.w.contact.kept_way;
  scene.move(scene.w.current, Vec3::Zero());
  find_contacts_of(scene.model, scene.inputs, scene.w, scene.w.current);
  scene.move(scene.w.trial, Vec3(0.6 * most, 0, 0));
  find_trial_contacts(scene.model, scene.inputs, scene.w);
  EXPECT_TRUE(scene.w.trial.keeps_contacts);
  std::swap(scene.w.current, scene.w.trial);
  scene.move(scene.w.trial, Vec3::Zero());  // there and back again
  find_trial_contacts(scene.model, scene.inputs, scene.w);
  EXPECT_FALSE(scene.w.trial.keeps_contacts);
  EXPECT_EQ(scene.w.trial.moved, 0);
}

TEST(KeptContacts, AreThoseOfClothAlone) {
  test::ContactScene scene(test::cube(3), {ground}, Vec3(0, 0, 0.1));
  scene.w.prepare(scene.model, scene.inputs.solver);
  begin_step(scene.model, scene.inputs, scene.state, scene.w);
  EXPECT_EQ(scene.w.contact.kept_way, 0);
}

// Friction follows from depths, so that it changes where contacts are kept: the objective that a step reports is that
// of its last contacts.
TEST(KeptContacts, CountInTheObjectiveAsTheyAreAtTheEnd) {
  SheetOn scene({"ball", shape_of(Sphere{0.2}), 0, 0.4}, 0.2);
  scene.state.x.col(0).array() -= 0.2;
  scene.state.x.col(1).array() -= 0.15;
  int kept = 0;
  for (int step = 0; step < 25; ++step) {
    ASSERT_FALSE(scene.step().failed);
    Iterate& end = scene.w.current;
    kept += end.moved > 0;
    EXPECT_LE(end.moved, scene.w.contact.kept_way);
    for (const Contact& contact : end.contacts) ASSERT_EQ(contact.depth, std::max(0.0, -gap(contact, end.x)));
    const double reported = end.g;
    const Positions gradient = end.gradient;
    evaluate(scene.model, scene.w, end, Wanted::gradient);
    EXPECT_NEAR(end.g, reported, 1e-9 * std::abs(reported));
    EXPECT_LT((end.gradient - gradient).norm(), 1e-6 * gradient.norm() + 1e-9);
  }
  EXPECT_GT(kept, 3) << "some steps end with contacts that were kept";
}

}  // namespace kept_contacts_test
}  // namespace supple
