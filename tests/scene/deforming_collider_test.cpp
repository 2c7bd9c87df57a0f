// Tests colliders that a motion deforms: beside the same colliders moved by keys, in what they do to bodies, in how
// their solids follow their files, and in what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "geometry/files/surface_file.h"
#include "geometry/files/vertex_motion.h"
#include "geometry/shapes/solid_motion.h"
#include "geometry/skins/skin.h"
#include "scene/building/collision_set.h"
#include "sim/measures/energies.h"
#include "support/bodies.h"
#include "support/motion_files.h"
#include "support/played_world.h"
#include "support/scene_text.h"
#include "support/surfaces.h"
#include "support/text_file.h"

namespace supple {
namespace deforming_collider_test {

// A plate of 1 x 0.125 x 1 m whose top is at y = 0. All coordinates are exact in single precision.
TriMesh plate() {
  TriMesh mesh;
  mesh.points.resize(8, 3);
  mesh.triangles.resize(12, 3);
  for (int v = 0; v < 8; ++v) mesh.points.row(v) << (v & 1 ? 0.5 : -0.5), (v & 2 ? 0 : -0.125), (v & 4 ? 0.5 : -0.5);
  mesh.triangles << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5,
      3, 7, 5;
  return mesh;
}

using Motion = std::function<Vec3(const Vec3& place, double time)>;

class DeformingColliders : public testing::Test {
 protected:
  static constexpr int rate = 60;  // of the frames of motions [1/s]
  test::TemporaryFolder folder;

  std::string file(const std::string& name) const { return (folder.path / name).string(); }

  // Writes a surface and its motion over a second as a series of OBJ files, whose numbers are exact.
  void write(const std::string& name, const TriMesh& mesh, const Motion& motion) const {
    test::write_text(file(name + ".obj"), test::obj_text(mesh));
    for (int f = 0; f <= rate; ++f) {
      Positions now = mesh.points;
      for (Eigen::Index v = 0; v < now.rows(); ++v)
        now.row(v) = motion(mesh.points.row(v).transpose(), double(f) / rate).transpose();
      test::write_text(file(fmt::format("{}_{}.obj", name, f)), test::obj_text({now, mesh.triangles}));
    }
  }

  std::string collider(const std::string& name, const std::string& keys) const {
    return fmt::format("[[collider]]\nname = \"plate\"\nshape = {{ surface = \"{}\" }}\n{}\n", file(name + ".obj"),
                       keys);
  }
  std::string moved(const std::string& name, const std::string& keys = "friction = 0.8") const {
    return collider(name, fmt::format("{}\nmotion = {{ file = \"{}\", fps = {} }}", keys, file(name + "_*.obj"), rate));
  }
};

std::string cube_at(const Vec3& place, const std::string& keys = "") {
  return fmt::format(
      "fps = 30\nsubsteps = 2\nframes = 30\n[[body]]\nname = \"cube\"\n"
      "box = {{ extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }}\nposition = [{}, {}, {}]\n"
      "material = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\n{}\n",
      place.x(), place.y(), place.z(), keys);
}

struct Film {
  explicit Film(const std::string& text, int count = 1)
      : threads(count), world(test::scene_of(text), assemble(test::scene_of(text))) {
    world.start({make_rule, settings_of}, &threads);
  }
  void play(int first, int end) {
    for (int frame = first; frame < end; ++frame) ASSERT_TRUE(world.play(frame)) << frame;
  }
  const Positions& x() const { return world.body(0).state().x; }
  Vec3 velocity() const { return world.body(0).state().v.colwise().mean().transpose(); }
  double lowest() const { return x().col(1).minCoeff(); }

  Threads threads;
  World world;
};

// Steps are solved, because what ten iterations leave depends on round-off: with these, films of both kinds end 1e-6 to
// 3e-4 m apart.
TEST_F(DeformingColliders, ARigidMotionGivesTheFilmOfTheSameKeys) {
  const std::string solved = "[solver]\niterations = 60\nstill = 0\nelements = \"double\"\nfactor = \"double\"\n";
  const Vec3 way(0.3, 0.25, 0);
  for (const double turn : {0.0, 40.0}) {  // about y, in a second [degrees]
    write("plate", plate(), [&](const Vec3& p, double time) {
      const Eigen::AngleAxisd by(time * turn * std::numbers::pi / 180, Vec3::UnitY());
      return Vec3(by * p + time * way);
    });
    for (const double height : {0.15, 0.1504, 0.1508}) {
      const std::string body = cube_at(Vec3(0.1, height, 0));
      Film keys(body +
                collider("plate", fmt::format("friction = 0.8\nease = \"linear\"\nkeys = [{{ t = 0 }}, {{ t = 1, "
                                              "move = [0.3, 0.25, 0], turn_deg = [0, {}, 0] }}]",
                                              turn)) +
                solved);
      Film cache(body + moved("plate") + solved);
      double furthest = 0;
      for (int frame = 0; frame < 30; ++frame) {
        keys.play(frame, frame + 1);
        cache.play(frame, frame + 1);
        furthest = std::max(furthest, (keys.x() - cache.x()).cwiseAbs().maxCoeff());
      }
      EXPECT_LT(furthest, 1e-6) << turn << ", " << height;
      EXPECT_GT(cache.velocity().y(), 0.2);  // the plate has taken the cube along
    }
  }
}

// The top of the plate rises by 0.5 m in a second, and its bottom stays.
TEST_F(DeformingColliders, ABodyRidesOnASurfaceThatRises) {
  write("plate", plate(),
        [](const Vec3& p, double time) { return Vec3(p.x(), p.y() < 0 ? p.y() : 0.5 * time, p.z()); });
  Film film(cube_at(Vec3(0, 0.101, 0)) + moved("plate"));
  film.play(0, 28);
  const double top = 0.5 * 28 / 30;
  EXPECT_NEAR(film.lowest(), top, 0.004);
  EXPECT_NEAR(film.velocity().y(), 0.5, 0.05);
}

// The work of the surface is what the cube has gained in height and speed.
TEST_F(DeformingColliders, TheWorkThatASurfaceDoesIsInTheBalanceOfEnergies) {
  write("plate", plate(),
        [](const Vec3& p, double time) { return Vec3(p.x(), p.y() < 0 ? p.y() : 0.5 * time, p.z()); });
  Film film(cube_at(Vec3(0, 0.1, 0)) + moved("plate"));
  MovingBody& body = film.world.body(0);
  EnergyBudget budget;
  Positions q;
  StepWatch watch;
  watch.prepared = [&](std::size_t, int) {
    OpenWorkspace& w = body.workspace();
    w.prepare(body.model(), body.inputs().solver);
    if (q.rows() == 0) budget.start(body.model(), body.inputs(), body.state(), w);
    budget.know_springs(body.model(), body.targets_at_start(), body.seams_at_start(), body.state());
    budget.before_step(body.model(), body.inputs(), body.state(), w);
    q = body.state().x;
  };
  watch.made = [&](std::size_t, int) {
    budget.after_step(body.model(), body.inputs(), q, body.state(), body.workspace());
  };
  for (int frame = 0; frame < 24; ++frame) ASSERT_TRUE(film.world.play(frame, watch));
  double mass = 0;
  for (int v = 0; v < body.model().free; ++v) mass += body.model().mass[v];
  const double gained = mass * (9.81 * 0.5 * 24 / 30 + 0.5 * 0.5 * 0.5);
  EXPECT_NEAR(budget.balance().put_in, gained, 0.1 * gained);
  EXPECT_LT(budget.balance().from_nothing, 0.05 * gained);
}

// A ball of triangles grows and shrinks below a cube, which must never be inside.
TEST_F(DeformingColliders, ABodyStaysOnABallThatBreathes) {
  const auto radius = [](double time) { return 0.4 * (1 + 0.15 * std::sin(2 * std::numbers::pi * 1.5 * time)); };
  write("ball", test::sphere_surface(0.4, 24, 12),
        [&](const Vec3& p, double time) { return Vec3(radius(time) / 0.4 * p); });
  Film film(cube_at(Vec3(0.01, 0.52, 0)) + moved("ball"));
  for (int frame = 0; frame < 30; ++frame) {
    film.play(frame, frame + 1);
    const double inside = radius((frame + 1) / 30.0) - film.x().rowwise().norm().minCoeff();
    EXPECT_LT(inside, 0.01) << frame;
  }
  EXPECT_GT(film.lowest(), 0.2);
}

TEST_F(DeformingColliders, FrictionCarriesABodyAlongWithASurfaceThatMovesSideways) {
  write("plate", plate(), [](const Vec3& p, double time) { return Vec3(p + 0.4 * time * Vec3::UnitX()); });
  Film rough(cube_at(Vec3(0, 0.1, 0)) + moved("plate", "friction = 0.8"));
  Film smooth(cube_at(Vec3(0, 0.1, 0)) + moved("plate", "friction = 0"));
  rough.play(0, 28);
  smooth.play(0, 28);
  EXPECT_NEAR(rough.velocity().x(), 0.4, 0.02);
  EXPECT_NEAR(smooth.velocity().x(), 0, 1e-3);
}

TEST_F(DeformingColliders, AWallThatComesThrowsABodyAndOneThatStaysDoesNot) {
  const auto wall_of = [](double speed) {
    return [speed](const Vec3& p, double time) { return Vec3(p + std::min(0.3, speed * time) * Vec3::UnitY()); };
  };
  const std::string body = "gravity = [0, 0, 0]\n" + cube_at(Vec3(0, 0.2, 0));
  write("plate", plate(), wall_of(2));
  Film hit(body + moved("plate"));
  hit.play(0, 10);
  EXPECT_GT(hit.velocity().y(), 1.5);
  EXPECT_GE(hit.lowest(), 0.29);
  write("plate", plate(), wall_of(0));
  Film still(body + moved("plate"));
  still.play(0, 10);
  EXPECT_EQ(still.velocity().norm(), 0);
}

TEST_F(DeformingColliders, ThreadsAndAResumedWorldGiveTheSameBits) {
  write("plate", plate(), [](const Vec3& p, double time) {
    return Vec3(p.x(), p.y() < 0 ? p.y() : 0.3 * time * (1 + p.x()), p.z() + 0.2 * time);
  });
  const std::string text = cube_at(Vec3(0, 0.12, 0)) + moved("plate");
  Film one(text), two(text, 2), resumed(text);
  one.play(0, 12);
  const WorldState middle = one.world.state();
  one.play(12, 20);
  two.play(0, 20);
  resumed.world.restore(middle);
  resumed.play(12, 20);
  EXPECT_EQ(one.world.hash(), two.world.hash());
  EXPECT_EQ(one.world.hash(), resumed.world.hash());
}

TEST_F(DeformingColliders, TimesOfTheMotionAreThoseOfItsKeys) {
  write("plate", plate(), [](const Vec3& p, double time) { return Vec3(p + time * Vec3::UnitX()); });
  const auto set = collision_set(
      test::scene_of(cube_at(Vec3(0, 1, 0)) +
                     collider("plate", fmt::format("motion = {{ file = \"{}\", fps = 20, start = 0.5, first = 6 }}",
                                                   file("plate_*.obj")))));
  const SceneCollider& collider = set.scene_colliders.front();
  EXPECT_EQ(collider.frame(0.2), 6);
  EXPECT_EQ(collider.frame(0.5), 6);
  EXPECT_DOUBLE_EQ(collider.frame(0.975), 15.5);
  EXPECT_EQ(collider.frame(100), rate);
  const Skin skin = drawn_collider(collider, {});
  ASSERT_FALSE(skin.vertex_of.empty());
  EXPECT_NEAR(drawn_places(collider, skin, 0.975).col(0).maxCoeff(), 0.5 + 15.5 / rate, 1e-12);
  EXPECT_NEAR(collider.shape_at(0.975).bounds().upper.x(), 0.5 + 15.5 / rate, 1e-12);
}

// Turns a surface and compares the solid with that of the rest, turned likewise.
TEST_F(DeformingColliders, CapsAndThickSheetsFollowTheirVertices) {
  const Eigen::AngleAxisd quarter(std::numbers::pi / 2, Vec3(1, 2, 2) / 3);
  for (const bool thick : {false, true}) {
    TriMesh open = test::sphere_surface(0.5, 16, 8);
    open.triangles.conservativeResize(open.triangles.rows() - 16 * (thick ? 4 : 1), 3);
    const std::string name = thick ? "sheet" : "pot";
    write(name, open, [&](const Vec3& p, double time) {
      return Vec3(Eigen::AngleAxisd(time * quarter.angle(), quarter.axis()) * p);
    });
    SurfaceOptions options;
    options.thickness = thick ? 0.05 : 0;
    options.close = thick ? Closing::automatic : Closing::caps;
    const SolidSurface made = read_solid_surface(file(name + ".obj"), options, nullptr);
    const ClosedSurface surface{std::make_shared<TriangleSolid>(made.boundary)};
    const SolidMotion motion(surface, file(name + ".obj"), options, read_vertex_motion(file(name + "_*.obj"), ""),
                             name);
    ASSERT_EQ(motion.frames(), rate + 1);
    const Positions turned = made.boundary.points * quarter.toRotationMatrix().transpose();
    EXPECT_LT((motion.points_at(0) - made.boundary.points).cwiseAbs().maxCoeff(), 1e-6) << name;
    EXPECT_LT((motion.points_at(rate) - turned).cwiseAbs().maxCoeff(), 1e-6) << name;
    EXPECT_GT(made.boundary.points.rows(), thick ? open.points.rows() : 0);
  }
}

TEST_F(DeformingColliders, AHandleThatIsAttachedGoesWithTheSurface) {
  // The plate is sheared and rises: a place of its surface moves by 0.4 z along x and by 0.2 upwards in a second.
  write("sheared", plate(),
        [](const Vec3& place, double time) { return Vec3(place + Vec3(0.4 * place.z() * time, 0.2 * time, 0)); });
  const std::string handle =
      "[[body.handles]]\nname = \"foot\"\nselect = { box = [[0, 0, 0], [1, 0.01, 1]] }\n"
      "attach = { collider = \"plate\" }\n";
  Film film(cube_at({0, 0, 0.25}, handle) + moved("sheared"));
  film.play(0, 30);
  const Model& model = film.world.body(0).model();
  ASSERT_EQ(model.handled.size(), 16u);
  for (const Model::HandleVertex& held : model.handled) {
    const Vec3 rest = model.rest.row(held.vertex), now = film.world.body(0).state().x.row(held.vertex);
    EXPECT_LT((now - rest - Vec3(0.4 * rest.z(), 0.2, 0)).norm(), 1e-6) << held.vertex;
  }
}

TEST_F(DeformingColliders, WhatCannotMoveIsRefused) {
  write("plate", plate(), [](const Vec3& p, double) { return p; });
  write("ball", test::sphere_surface(0.4, 8, 4), [](const Vec3& p, double) { return p; });
  const auto problem_of = [&](const std::string& text) {
    const std::vector<std::string> list = test::problems_of(cube_at(Vec3(0, 1, 0)) + text);
    return list.size() == 1 ? list.front() : fmt::format("{} problems: {}", list.size(), fmt::join(list, " | "));
  };
  const auto expect = [&](const std::string& text, const std::string& said) {
    const std::string problem = problem_of(text);
    EXPECT_NE(problem.find(said), std::string::npos) << problem;
  };
  const auto with = [&](const std::string& motion) { return collider("plate", "motion = { " + motion + " }"); };
  expect(with(fmt::format("file = \"{}\"", file("ball_*.obj"))),
         fmt::format("ball_0.obj: moves 26 vertices, and the surface '{}' has 8", file("plate.obj")));
  expect(with(fmt::format("file = \"{}\", first = 61", file("plate_*.obj"))), "first = 61: must be below 61");
  expect(with("file = \"nowhere_*.obj\""), "file = 'nowhere_*.obj': no such file");
  expect(with("fps = 20"), "a motion needs a 'file': a .pc2 or .mdd point cache");
  expect("[[collider]]\nshape = { sphere = { radius = 1 } }\n" +
             fmt::format("motion = {{ file = \"{}\" }}\n", file("plate_*.obj")),
         "motion: of a collider whose shape is one surface file");
}

}  // namespace deforming_collider_test
}  // namespace supple
