// Tests what a step does about contacts that a search along a direction did not foresee.
#include "sim/solver/unforeseen_contacts.h"

#include <gtest/gtest.h>

#include "support/contact_scene.h"

namespace supple {
namespace unforeseen_contacts_test {

using test::cube;
using test::shape_of;

// Moves all free vertices of an iterate from where the step began, and finds the contacts there.
void place(test::ContactScene& scene, Iterate& iterate, const Vec3& moved) {
  iterate.x = scene.state.x;
  iterate.x.topRows(scene.model.free).rowwise() += moved.transpose();
  find_contacts_of(scene.model, scene.inputs, scene.w, iterate);
}

// The contacts that the current iterate learns count in its objective and gradient as if they had been found there.
TEST(UnforeseenContacts, AreLearnedByTheCurrentIterate) {
  const Collider post{"post", shape_of(Capsule{Vec3(0.012, -1, 0.021), Vec3(0.012, -0.004, 0.021), 0.004}), 0, 0.4};
  const Collider ground{"ground", shape_of(HalfSpace{Vec3::UnitY(), -0.05}), 0, 0.4};
  for (const auto& [before, ahead] : {std::pair{-0.05, -0.11}, std::pair{-0.04, -0.09}}) {
    test::ContactScene scene(cube(3), {post, ground}, Vec3(0, 0.15, 0));
    scene.inputs.solver.contact.points = ContactPoints::surface;
    scene.state.v.col(1).setConstant(-6);
    scene.w.prepare(scene.model, scene.inputs.solver);
    begin_step(scene.model, scene.inputs, scene.state, scene.w);
    place(scene, scene.w.current, Vec3(0, before, 0));
    scene.w.current.contacts.clear();  // as if nothing had been near
    evaluate(scene.model, scene.w, scene.w.current, Wanted::gradient);
    scene.w.report.objective = {scene.w.current.g};
    scene.w.report.decrease = 0;
    const double unknowing = scene.w.current.g;
    place(scene, scene.w.trial, Vec3(0, ahead, 0));
    ASSERT_FALSE(scene.w.trial.contacts.empty());

    ASSERT_TRUE(learn_contacts(scene.model, scene.inputs, scene.w));
    const Iterate learned = scene.w.current;
    EXPECT_FALSE(learned.contacts.empty());
    EXPECT_EQ(scene.w.report.objective.back(), learned.g);
    EXPECT_EQ(scene.w.report.decrease, unknowing - learned.g);
    for (const Contact& contact : learned.contacts) {
      const bool is_ahead = gap(contact, learned.x) >= 0;
      EXPECT_TRUE(is_ahead || !contact.stencil.is_vertex()) << "the iterate knew of vertices";
    }
    evaluate(scene.model, scene.w, scene.w.current, Wanted::gradient);
    EXPECT_NEAR(scene.w.current.g, learned.g, 1e-12 * learned.g);
    EXPECT_LT((scene.w.current.gradient - learned.gradient).norm(), 1e-9 * learned.gradient.norm());
    EXPECT_FALSE(learn_contacts(scene.model, scene.inputs, scene.w)) << "there was nothing left to learn";
    EXPECT_EQ(scene.w.current.contacts.size(), learned.contacts.size());
  }
}

}  // namespace unforeseen_contacts_test
}  // namespace supple
