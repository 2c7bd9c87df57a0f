// Tests contact with rigid colliders: energies and their derivatives, momentum, tunnelling, overlaps, rest, friction.
// contact_direction_test.cpp has the search directions.
#include "sim/contact/contact.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "baselines/reference.h"
#include "geometry/solids/triangle_solid.h"
#include "sim/measures/measures.h"
#include "support/contact_scene.h"
#include "support/surfaces.h"

namespace supple {
namespace contact_test {

using test::cube;
using test::Held;
using test::moved_to;
using test::shaken;
using test::shape_of;

const Shape ground = shape_of(HalfSpace{Vec3::UnitY(), 0});

// The scene of the tests, whose steps must not fail.
struct ContactScene : test::ContactScene {
  using test::ContactScene::ContactScene;
  const StepReport& advance() {
    const StepReport& report = step();
    EXPECT_FALSE(report.failed) << report.failure.what;
    return report;
  }
};

TEST(Contact, StepsAreMadeWithAnyDirection) {
  for (const auto& direction : Names<ContactDirection>::table) {
    SCOPED_TRACE(direction.text);
    ContactScene scene(cube(3), {{"ground", ground, 0, 0.3}}, Vec3(0, 0.12, 0));
    scene.inputs.solver.contact.direction = direction.value;
    int touching = 0;
    for (int step = 0; step < 12; ++step) touching += scene.advance().contacts.touching;
    EXPECT_GT(touching, 0);
  }
}

TEST(Contact, GradientIsTheDerivativeOfTheEnergyWithPlanesAsTheyStand) {
  ContactScene scene(cube(2), {{"ball", shape_of(Sphere{0.3}), 0.01, 0.4}}, Vec3(0, 0.405, 0));
  scene.state.v.rowwise() = Eigen::RowVector3d(2, -1.5, 1);
  scene.w.prepare(scene.model, scene.inputs.solver);
  begin_step(scene.model, scene.inputs, scene.state, scene.w);
  find_contacts_of(scene.model, scene.inputs, scene.w, scene.w.current);
  const std::vector<Contact>& found = scene.w.current.contacts;
  EXPECT_GT(std::count_if(found.begin(), found.end(), [](const Contact& c) { return c.depth > 0; }), 3);
  EXPECT_GT(std::count_if(found.begin(), found.end(), [](const Contact& c) { return c.friction > 0; }), 3);
  test::expect_derivative_of_contacts(scene);
}

// The planes are found again at each point, so that the energy of the reference is the one whose gradient the planes
// give.
TEST(Contact, PlanesGiveTheDerivativeOfTheEnergyFoundAnew) {
  Shape blend = shape_of(Sphere{0.2});
  blend.root.parts.push_back({Capsule{Vec3(0, 0, 0), Vec3(0.3, 0, 0), 0.1}});
  blend.root.parts.back().blend = 0.1;
  const std::vector<std::pair<std::string, Shape>> shapes = {{"half space", shape_of(HalfSpace{Vec3(0, 1, 0), 0.19})},
                                                             {"sphere", shape_of(Sphere{0.2})},
                                                             {"ellipsoid", shape_of(Ellipsoid{Vec3(0.3, 0.2, 0.25)})},
                                                             {"box", shape_of(Box{Vec3(0.3, 0.2, 0.3), 0.02})},
                                                             {"cylinder", shape_of(Cylinder{0.3, 0.2, 0.02})},
                                                             {"torus", shape_of(Torus{0.1, 0.2})},
                                                             {"blend", blend}};
  for (const auto& [name, shape] : shapes) {
    ContactScene scene(cube(2), {{name, shape}}, Vec3(0.02, 0.305, 0.01));
    scene.state.v.rowwise() = Eigen::RowVector3d(0.1, -0.9, 0.05);
    scene.w.prepare(scene.model, scene.inputs.solver);
    begin_step(scene.model, scene.inputs, scene.state, scene.w);
    const Positions x = scene.w.current.x, direction = shaken(Positions::Zero(scene.model.free, 3), 1, 6);
    find_contacts_of(scene.model, scene.inputs, scene.w, scene.w.current);
    Positions gradient = Positions::Zero(scene.model.free, 3);
    const double slope = add_contacts(scene.w.current.contacts, x, nullptr, direction, &gradient).slope;
    ASSERT_NE(slope, 0) << name;
    double best = 1e300;
    for (const double h : {1e-6, 1e-7}) {
      const double forward = contact_energy_at(scene.model, scene.inputs, x + h * direction, scene.w);
      const double backward = contact_energy_at(scene.model, scene.inputs, x - h * direction, scene.w);
      best = std::min(best, std::abs((forward - backward) / (2 * h) - slope));
    }
    EXPECT_LT(best, 1e-5 * std::abs(slope)) << name;
  }
}

TEST(Contact, MomentumChangesByTheImpulsesOfGravityAndContacts) {
  for (const int iterations : {300, 4}) {
    ContactScene scene(cube(3), {{"ball", shape_of(Sphere{0.5}), 0, 0.3}}, Vec3(0.05, 0.61, 0));
    scene.state.v.rowwise() = Eigen::RowVector3d(0.3, -1, 0.1);
    scene.inputs.solver.iterations = iterations;
    const double h = scene.model.time_step;
    int touched = 0;  // frames: it bounces
    for (int frame = 0; frame < 5; ++frame) {
      const auto momentum = [&] {
        Vec3 sum = Vec3::Zero();
        for (int v = 0; v < scene.model.vertices; ++v) sum += scene.model.mass[v] * Vec3(scene.state.v.row(v));
        return sum;
      };
      const Vec3 before = momentum();
      const StepReport& report = scene.advance();
      touched += report.contacts.touching > 0;
      const Vec3 left = scene.w.current.gradient.colwise().sum().transpose();  // zero at a minimum
      const Vec3 impulse = h * (scene.model.total_mass * scene.inputs.gravity + report.contact_force);
      const double scale = before.norm() + impulse.norm();
      EXPECT_LT((momentum() - before - impulse - h * left).norm(), 1e-9 * scale) << frame;
      if (iterations == 300) {
        EXPECT_LT((momentum() - before - impulse).norm(), 1e-9 * scale) << frame;
      }
    }
    EXPECT_GE(touched, 3);
  }
}

TEST(Contact, NothingGoesThroughAtAnySpeedUpToItsSizeAStep) {
  const double size = 0.2 * std::sqrt(3.0), fastest = size * 30;
  struct SceneCollider {
    std::string name;
    Shape shape;
    double top;  // height of its surface on the y axis
  };
  const std::vector<SceneCollider> obstacles = {
      {"plane", ground, 0},
      {"box", shape_of(Box{Vec3(1, 0.2, 1), 0}), 0.2},
      {"sphere", shape_of(Sphere{0.5}), 0.5},
      {"torus, onto its tube", shape_of(Torus{0.5, 0.2}), 0.2},
      {"plate of a hundredth", shape_of(Box{Vec3(1, 0.005 * size, 1), 0}), 0.005 * size}};
  for (const SceneCollider& obstacle : obstacles) {
    for (const double speed : {1.0, 2.0, 5.0, fastest}) {
      const double x = obstacle.name.starts_with("torus") ? 0.5 : 0.0;
      ContactScene scene(cube(3), {{obstacle.name, obstacle.shape}}, Vec3(x, obstacle.top + 0.13, 0.02));
      scene.state.v.col(1).setConstant(-speed);
      double deepest = 0;
      for (int frame = 0; frame < 8; ++frame) {
        scene.advance();
        deepest = std::max(deepest, scene.deepest(0));
        if (!obstacle.name.starts_with("plate") && obstacle.name != "box") continue;
        // A body below the middle of a plate has passed through it.
        EXPECT_GT(scene.state.x.col(1).minCoeff(), 0) << obstacle.name << " at " << speed << " m/s, frame " << frame;
      }
      EXPECT_LT(deepest, 0.02 * size) << obstacle.name << " at " << speed << " m/s";
      if (!obstacle.name.starts_with("torus")) {  // it slides off the torus's tube
        EXPECT_GT(scene.center().y(), obstacle.top) << obstacle.name << " at " << speed << " m/s";
      }
      RecordProperty(obstacle.name + fmt::format(" {:.3g}", speed), fmt::format("{:.2e}", deepest / size));
    }
  }
}

// The collider moves towards the body, and it is thin and fast.
TEST(Contact, APlateThatMovesFastIsNotLetThrough) {
  ContactScene scene(cube(3), {{"plate", shape_of(Box{Vec3(1, 0.002, 1), 0})}});
  scene.inputs.gravity.setZero();
  double height = -0.15;
  for (int frame = 0; frame < 6; ++frame) {
    scene.inputs.collider_motions[0] = {moved_to(Vec3(0, height, 0)), moved_to(Vec3(0, height + 0.3, 0))};
    height += 0.3;
    scene.advance();
    EXPECT_GT(scene.state.x.col(1).minCoeff(), height) << frame;
  }
}

TEST(Contact, ColliderThatTurnsCarriesWhatStandsOnIt) {
  ContactScene scene(cube(2), {{"disc", shape_of(Cylinder{1, 0.05, 0}), 0, 1.0}}, Vec3(0.5, 0.1501, 0));
  scene.inputs.solver.iterations = 30;
  const double turn = 0.02;  // the collider's turn in a step
  for (int frame = 0; frame < 40; ++frame) {
    scene.inputs.collider_motions[0].start = Eigen::AngleAxisd(turn * frame, Vec3::UnitY());
    scene.inputs.collider_motions[0].end = Eigen::AngleAxisd(turn * (frame + 1), Vec3::UnitY());
    scene.advance();
  }
  const Vec3 at = scene.center();
  EXPECT_NEAR(std::atan2(-at.z(), at.x()), 40 * turn, 0.06);
  EXPECT_NEAR(std::hypot(at.x(), at.z()), 0.5, 0.02);
}

TEST(Contact, OverlapsArePushedOutNoFasterThanAllowed) {
  const std::vector<std::pair<std::string, Shape>> shapes = {
      {"plane", ground},
      {"sphere", shape_of(Sphere{0.5})},
      {"box", shape_of(Box{Vec3(0.6, 0.3, 0.6), 0.02})},
      {"capsule", shape_of(Capsule{Vec3(-0.5, 0, 0), Vec3(0.5, 0, 0), 0.3})},
      {"cylinder", shape_of(Cylinder{0.6, 0.3, 0})},
      {"torus", shape_of(Torus{0.5, 0.3})},
      {"triangles", shape_of(ClosedSurface{std::make_shared<TriangleSolid>(test::sphere_surface(0.5, 20, 14))})}};
  for (const auto& [name, shape] : shapes) {
    const double x = name == "torus" ? 0.5 : 0,
                 top = shape.distance(Vec3(x, 10, 0)) > 9 ? 10 - shape.distance(Vec3(x, 10, 0)) : 0;
    for (const double sunk : {0.1, 0.22}) {  // half inside and wholly inside
      ContactScene scene(cube(3), {{name, shape}}, Vec3(x, top + 0.1 - sunk, 0.01));
      scene.inputs.gravity.setZero();
      double fastest = 0;
      int frames = 0;
      while (scene.deepest(0) > 1e-3 * scene.model.size && frames < 150) {
        const Positions before = scene.state.x;
        scene.advance();
        fastest = std::max(fastest, (scene.state.x - before).rowwise().norm().maxCoeff() / scene.model.time_step);
        ++frames;
      }
      ASSERT_TRUE(scene.state.x.allFinite());
      EXPECT_LT(scene.deepest(0), 0.01 * scene.model.size) << name << ", sunk by " << sunk;
      // A body that is pushed also swings, so a few times the limit does not count as an explosion.
      EXPECT_LT(fastest, 4 * scene.inputs.solver.contact.push_out * scene.model.size) << name << ", sunk by " << sunk;
    }
  }
}

TEST(Contact, ABodyAtRestStaysAtRestForAMinute) {
  ContactScene scene(cube(3), {{"ground", ground, 0, 0.5}}, Vec3(0, 0.1, 0));
  for (int frame = 0; frame < 300; ++frame) scene.advance();
  const Vec3 settled = scene.center();
  double fastest = 0;
  int changes = 0;
  std::uint64_t set = 0;  // hash of the vertices that touch
  for (int frame = 300; frame < 1800; ++frame) {
    const StepReport& report = scene.advance();
    fastest = std::max(fastest, scene.fastest());
    EXPECT_GT(report.contacts.touching, 0);
    if (frame >= 1770) changes += scene.w.contact.set_now != set;
    set = scene.w.contact.set_now;
  }
  EXPECT_LT(fastest, 1e-4 * scene.model.size);
  // What friction has held since the first step, when the body sags, lets go slowly, over the whole minute.
  EXPECT_LT((scene.center() - settled).norm(), 3e-4 * scene.model.size);
  EXPECT_EQ(changes, 0);
}

TEST(Contact, FrictionHoldsOrSlidesAsCoulombSays) {
  const double angle = 20 * 3.14159265358979 / 180, g = 9.81;
  const Vec3 normal(0, std::cos(angle), std::sin(angle)), down(0, -std::sin(angle), std::cos(angle));
  for (const double friction : {0.0, 0.2, 0.3, 0.45}) {
    BodyDescription body = cube(3, Corotated{3e5, 6e5});
    body.mesh.rest = body.mesh.rest * Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix().transpose();
    ContactScene scene(body, {{"slope", shape_of(HalfSpace{normal, 0}), 0, friction}}, 0.1 * normal);
    for (int frame = 0; frame < 15; ++frame) scene.advance();
    const double start = scene.center().dot(down), speed = (scene.state.v.colwise().mean() * down)(0);
    for (int frame = 0; frame < 45; ++frame) scene.advance();
    const double time = 1.5, acceleration = ((scene.state.v.colwise().mean() * down)(0) - speed) / time;
    const double expected = g * (std::sin(angle) - friction * std::cos(angle));
    if (expected > 0) {
      EXPECT_NEAR(acceleration, expected, 0.05 * g * std::sin(angle)) << friction;
    } else {
      EXPECT_LT(std::abs(scene.center().dot(down) - start),
                2 * time * scene.inputs.solver.contact.stick * scene.model.size)
          << friction;
    }
  }
}

// Sticking is smooth, so what friction holds creeps a little.
TEST(Contact, ABodyThatFrictionHoldsOnASlopeCreepsByLessThanATenThousandthOfItsSizeASecond) {
  const double angle = 20 * 3.14159265358979 / 180;
  const Vec3 normal(0, std::cos(angle), std::sin(angle));
  BodyDescription body = cube(3, Corotated{3e5, 6e5});
  body.mesh.rest = body.mesh.rest * Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix().transpose();
  ContactScene scene(body, {{"slope", shape_of(HalfSpace{normal, 0}), 0, 0.5}}, 0.1 * normal);
  for (int frame = 0; frame < 60; ++frame) scene.advance();
  const Vec3 start = scene.center();
  for (int frame = 0; frame < 90; ++frame) scene.advance();
  EXPECT_LT((scene.center() - start).norm(), 3 * 1e-4 * scene.model.size);
}

TEST(Contact, AClothThatLiesOnABallStaysThere) {
  BodyDescription net = test::spring_net(16);
  for (double& mass : net.point_mass) mass *= 0.2;
  net.mesh.rest.rowwise() -= Eigen::RowVector3d(0.19, 0.2, 0);  // it hangs a little more to one side
  net.mesh.rest =
      net.mesh.rest * Eigen::AngleAxisd(0.5 * 3.14159265358979, Vec3::UnitX()).toRotationMatrix().transpose();
  ContactScene scene(net, {{"ball", shape_of(Sphere{0.15}), 0, 0.5}}, Vec3(0, 0.151, 0));
  for (int frame = 0; frame < 150; ++frame) scene.advance();
  const Positions start = scene.state.x;
  const double seconds = 5;
  for (int frame = 0; frame < 30 * seconds; ++frame) scene.advance();
  double furthest = 0;
  for (const Contact& contact : scene.w.current.contacts) {
    if (contact.depth > 0)
      furthest = std::max(furthest, (contact.stencil.at(scene.state.x) - contact.stencil.at(start)).norm());
  }
  EXPECT_GT(scene.w.contact.counts.touching, 20);
  EXPECT_LT(furthest, seconds * 1e-3 * scene.model.size);
}

TEST(Contact, SameBitsWhateverTheWorkspaceDidBefore) {
  const auto hashes = [](ContactScene& scene, int frames) {
    std::vector<std::uint64_t> list;
    for (int frame = 0; frame < frames; ++frame) {
      scene.advance();
      list.push_back(state_hash(scene.model, scene.state));
    }
    return list;
  };
  const std::vector<Collider> colliders = {{"ball", shape_of(Sphere{0.3}), 0, 0.3}, {"ground", ground}};
  BodyDescription body = cube(4);
  body.precision = Precision::single_precision;
  ContactScene fresh(body, colliders, Vec3(0.1, 0.42, 0));
  const auto expected = hashes(fresh, 20);
  fresh.state = rest_state(fresh.model);  // the same workspace, which now knows what it touched
  fresh.state.x.rowwise() += Eigen::RowVector3d(0.1, 0.42, 0);
  EXPECT_EQ(hashes(fresh, 20), expected);
  // Starts from a snapshot in the middle of contact.
  ContactScene snapshot(body, colliders);
  snapshot.state = fresh.state;
  EXPECT_GT(fresh.w.contact.counts.touching, 0);
  EXPECT_EQ(hashes(snapshot, 5), hashes(fresh, 5));
  ContactScene threaded(body, colliders, Vec3(0.1, 0.42, 0));
  Threads threads(3);
  threaded.w.threads = &threads;
  EXPECT_EQ(hashes(threaded, 20), expected);
}

// What is remembered of triangles from step to step saves work alone.
TEST(Contact, SameBitsOnAMeshWhateverTheWorkspaceDidBefore) {
  for (const double thickness : {0.0, 0.01}) {
    const auto solid = std::make_shared<const TriangleSolid>(test::sphere_surface(0.3, 60, 30));
    const std::vector<Collider> colliders = {{"ball", shape_of(ClosedSurface{solid}), thickness, 0.3},
                                             {"ground", ground, thickness}};
    const Vec3 place(0.1, 0.42, 0);
    ContactScene used(cube(4), colliders, place), threaded(cube(4), colliders, place);
    Threads threads(3);
    threaded.w.threads = &threads;
    for (ContactScene* scene : {&used, &threaded})
      scene->inputs.collider_motions[0].end = scene->inputs.collider_motions[0].start = moved_to(Vec3(0.01, 0, 0.02));
    for (int frame = 0; frame < 25; ++frame) {
      // A workspace that knows nothing makes the same step.
      ContactScene fresh(cube(4), colliders);
      fresh.inputs.collider_motions = used.inputs.collider_motions;
      fresh.state = used.state;
      fresh.advance();
      used.advance();
      threaded.advance();
      EXPECT_EQ(state_hash(fresh.model, fresh.state), state_hash(used.model, used.state)) << frame;
      EXPECT_EQ(state_hash(threaded.model, threaded.state), state_hash(used.model, used.state)) << frame;
    }
    EXPECT_GT(used.w.contact.counts.touching, 0);
  }
}

TEST(Contact, CostsNothingWithoutColliders) {
  ContactScene scene(cube(2), {});
  scene.inputs.colliders = nullptr;
  scene.inputs.collider_motions.clear();
  const StepReport& report = scene.advance();
  EXPECT_EQ(report.collide_ms, 0);
  EXPECT_TRUE(scene.w.contact.clearance.empty());
  EXPECT_EQ(scene.w.correction.system.kept_numbers(), 0);
}

// A step's way is a thousand times the plate's thickness, and the force of the impact presses a vertex further than
// half of it where contact is as stiff as on thick shapes. Corners then hung on the plate's other side for ever.
TEST(Contact, APlateOfAMillimetreThrowsBackWhatIsFast) {
  for (const double thickness : {0.01, 0.001, 0.0001}) {
    for (const bool plate_flies : {false, true}) {
      SCOPED_TRACE(fmt::format("{} m, {}", thickness, plate_flies ? "plate flies" : "cube flies"));
      ContactScene scene(cube(4, NeoHookean::from(Lame::from_young(1e5, 0.4))),
                         {{"plate", shape_of(Box{Vec3(0.5, thickness / 2, 0.5), 0})}});
      scene.inputs.gravity.setZero();
      const double velocity = plate_flies ? 30 : 0;
      if (!plate_flies) scene.state.v.col(1).setConstant(-30);
      double place = -0.6;
      for (int frame = 0; frame < 20; ++frame) {
        const double next = place + scene.model.time_step * velocity;
        scene.inputs.collider_motions[0] = {moved_to(Vec3(0, place, 0)), moved_to(Vec3(0, next, 0))};
        place = next;
        scene.advance();
      }
      EXPECT_GT(scene.state.x.col(1).minCoeff(), place + 0.1);
      EXPECT_LT(deformation(scene.model, scene.state.x).stretch, 1.2);
    }
  }
}

}  // namespace contact_test
}  // namespace supple
