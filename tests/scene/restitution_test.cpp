// Tests bounces with restitution: how high a ball rises, momentum and energy of bodies that meet, what moves and what
// is held, that what rests stays at rest, that bits depend neither on threads nor on where a film was resumed, and what
// is refused.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "film/record/checkpoint.h"
#include "scene/reading/sagging.h"
#include "sim/solver/rigid_motion.h"
#include "support/bodies.h"
#include "support/energy_watch.h"
#include "support/played_world.h"
#include "support/scene_text.h"
#include "support/text_file.h"
#include "world/restitution.h"

namespace supple {
namespace restitution_test {

const std::string ground = "[[collider]]\nname = \"ground\"\nshape = { half_space = { normal = [0, 1, 0] } }\n";

std::string ball(const std::string& name, const std::string& place, double young, double restitution) {
  return fmt::format(R"([[body]]
name = "{}"
shape = "shapes/sphere.toml"
size = 0.2
vertices = 300
material = {{ model = "stable-neo-hookean", young = {:g}, poisson = 0.4 }}
contact = {{ restitution = {} }}
{}
)",
                     name, young, restitution, place);
}

World world_of(const std::string& text, Threads* threads = nullptr) {
  World world(test::scene_of(text), assemble(test::scene_of(text)));
  world.start({make_rule, settings_of}, threads);
  return world;
}

// Returns a velocity of a body's centre of mass.
Vec3 velocity(const World& world, std::size_t body) {
  const Model& model = world.body(body).model();
  Vec3 momentum = Vec3::Zero();
  for (int v = 0; v < model.vertices; ++v) momentum += model.mass[v] * world.body(body).state().v.row(v).transpose();
  return momentum / model.total_mass;
}

Vec3 center(const World& world, std::size_t body) {
  const Model& model = world.body(body).model();
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < model.vertices; ++v) sum += model.mass[v] * world.body(body).state().x.row(v).transpose();
  return sum / model.total_mass;
}

// Returns the angular momentum of all bodies about the origin [kg m^2/s].
Vec3 angular_momentum(const World& world) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t b = 0; b < world.size(); ++b) {
    const State& state = world.body(b).state();
    for (int v = 0; v < world.body(b).model().vertices; ++v) {
      const Vec3 x = state.x.row(v), velocity = state.v.row(v);
      sum += world.body(b).model().mass[v] * x.cross(velocity);
    }
  }
  return sum;
}

// Returns how high a ball's centre rises again, over its fall from a height of its bottom.
double rise_over_fall(double young, double restitution, double fps, double height) {
  World world = world_of(fmt::format("fps = {}\nframes = {}\n", fps, int(3 * fps)) +
                         ball("ball", fmt::format("position = [0, {}, 0]", height), young, restitution) + ground);
  const double start = center(world, 0).y();
  bool has_landed = false;
  double lowest = start, top = 0;
  for (int frame = 0; frame < world.scene().frames; ++frame) {
    EXPECT_TRUE(world.play(frame));
    const double y = center(world, 0).y();
    lowest = std::min(lowest, y);
    has_landed |= velocity(world, 0).y() > 0;
    if (has_landed) top = std::max(top, y);
    if (has_landed && velocity(world, 0).y() < 0) break;
  }
  return (top - start + height) / height;
}

TEST(Restitution, ABallRisesByTheSquareOfTheShareThatItKeeps) {
  for (const double fps : {30, 120}) {
    for (const double young : {1e5, 1e7}) {
      for (const double restitution : {0.5, 0.8, 1.0}) {
        for (const double height : {1.0, 1.1}) {
          const double wanted = restitution * restitution, rise = rise_over_fall(young, restitution, fps, height);
          EXPECT_NEAR(rise, wanted, fps < 100 ? 0.11 : 0.04)
              << fps << " frames a second, " << young << " Pa, " << restitution << ", from " << height << " m";
        }
      }
    }
  }
}

// Two balls that meet in the air, the second one `aside` off the line of the first one [m].
std::string meeting(double restitution, double aside) {
  return "gravity = [0, 0, 0]\n" +
         ball("left", fmt::format("position = [-0.3, {}, 0]\nvelocity = [2, 0, 0]", aside), 1e6, restitution) +
         ball("right", "position = [0.3, 0, 0]\nvelocity = [-1, 0, 0]\ndensity = 2000", 1e6, 0);
}

TEST(Restitution, BodiesThatMeetGoApartAsTheyShouldAndKeepTheirMomentum) {
  const auto cube = [](const char* name, const char* start, double restitution) {
    return fmt::format(R"([[body]]
name = "{}"
box = {{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }}
{}
material = {{ model = "stable-neo-hookean", young = 1e6, poisson = 0.4 }}
contact = {{ restitution = {} }}
)",
                       name, start, restitution);
  };
  for (const double restitution : {0.6, 1.0}) {
    World world =
        world_of("gravity = [0, 0, 0]\n" + cube("left", "position = [-0.3, 0, 0]\nvelocity = [2, 0, 0]", restitution) +
                 cube("right", "position = [0.3, 0, 0]\nvelocity = [-1, 0, 0]\ndensity = 2000", 0));
    const Vec3 before = velocity(world, 0) + 2 * velocity(world, 1);
    for (int frame = 0; frame < 20; ++frame) EXPECT_TRUE(world.play(frame));
    EXPECT_LT((velocity(world, 0) + 2 * velocity(world, 1) - before).norm(), 1e-9);
    EXPECT_NEAR((velocity(world, 1) - velocity(world, 0)).x(), 3 * restitution, 0.03);
  }
}

TEST(Restitution, AGlancingHitKeepsTheAngularMomentum) {
  World with = world_of(meeting(0.9, 0.08)), without = world_of(meeting(0, 0.08));
  const Vec3 before = angular_momentum(with);
  for (int frame = 0; frame < 20; ++frame) {
    EXPECT_TRUE(with.play(frame));
    EXPECT_TRUE(without.play(frame));
  }
  const double lost = (angular_momentum(without) - before).norm();  // to the iterations that a step is given
  EXPECT_LT((angular_momentum(with) - before).norm(), 1.5 * lost + 1e-3 * before.norm());
  EXPECT_GT((velocity(with, 1) - velocity(with, 0)).x(), 0.5 + (velocity(without, 1) - velocity(without, 0)).x());
}

TEST(Restitution, CountsItsEnergyAndGivesNoMoreThanTheImpactTook) {
  World alone = world_of(ball("ball", "position = [0, 1, 0]", 1e6, 0.9) + ground), pair = world_of(meeting(0.9, 0.04));
  for (World* world : {&alone, &pair}) {
    double put_in = 0;
    EXPECT_LT(test::share_from_nothing(*world, 25, put_in), 0.02);
    const MovingBody& body = world->body(0);
    EXPECT_GT(body.state().bounces.given, 0);
    const double at_impact = world == &alone ? body.model().total_mass * standard_gravity : body.model().total_mass * 3;
    EXPECT_LT(body.state().bounces.given, at_impact);
  }
}

TEST(Restitution, ACubeThatLandsOnItsEdgeBeginsToTurn) {
  const std::string cube = R"([[body]]
name = "cube"
box = { extent = [0.3, 0.1, 0.1], cells = [6, 2, 2] }
position = [0, 0.5, 0]
turn_deg = [0, 0, 40]
material = { model = "stable-neo-hookean", young = 1e6, poisson = 0.4 }
contact = { restitution = 0.8 }
)";
  World world = world_of(cube + ground);
  const State& state = world.body(0).state();
  while (state.bounces.given == 0 && world.frames() < 30) EXPECT_TRUE(world.play(world.frames()));
  const RigidMotion rigid = rigid_motion(world.body(0).model(), state.x, state.v);
  EXPECT_LT(rigid.angular.z(), -5);  // its lower end, on the left, is thrown up
}

TEST(Restitution, AFloorOfTilesIsAsOneFloor) {
  const auto energy = [](const std::string& floor) {
    World world = world_of(R"([[body]]
name = "slab"
box = { extent = [0.4, 0.16, 0.4], cells = [4, 2, 4] }
position = [0.03, 0.5, 0.02]
material = { model = "stable-neo-hookean", young = 1e6, poisson = 0.4 }
contact = { restitution = 0.9 }
)" + floor);
    const double start = center(world, 0).y();
    double top = 0;
    while (world.frames() < 24) {
      EXPECT_TRUE(world.play(world.frames()));
      if (world.body(0).state().bounces.given > 0) top = std::max(top, center(world, 0).y());
    }
    EXPECT_LT(std::hypot(velocity(world, 0).x(), velocity(world, 0).z()), 0.05);
    return (top - start + 0.5) / 0.5;
  };
  std::string tiles;
  for (int i = 0; i < 36; ++i)
    tiles += fmt::format(
        "[[collider]]\nname = \"t{}\"\nshape = {{ box = {{ extent = [0.15, 0.1, 0.15] }} }}\nposition = [{}, -0.05, "
        "{}]\n",
        i, 0.15 * (i % 6) - 0.375, 0.15 * (i / 6) - 0.375);
  const double one = energy(ground);
  EXPECT_NEAR(one, 0.81, 0.1);
  EXPECT_NEAR(energy(tiles), one, 0.05);
  EXPECT_NEAR(energy(ground + "[[collider]]\nname = \"again\"\nshape = { half_space = { normal = [0, 1, 0] } }\n"), one,
              0.02);
}

TEST(Restitution, ABallBouncesOffALightMatOnTheGround) {
  const std::string mat = R"([[body]]
name = "mat"
box = { extent = [0.6, 0.05, 0.6], cells = [6, 1, 6] }
density = 50
material = { model = "stable-neo-hookean", young = 1e7, poisson = 0.3 }
)";
  World world = world_of(ball("ball", "position = [0, 0.6, 0]", 1e8, 0.9) + mat + ground);
  double top = 0;
  while (world.body(0).state().bounces.given == 0 && world.frames() < 30) EXPECT_TRUE(world.play(world.frames()));
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(world.play(world.frames()));
    top = std::max(top, center(world, 0).y() - 0.15);
  }
  EXPECT_GT(top, 0.2) << "the ground bears what the mat cannot";
  EXPECT_LT(top, 0.81 * 0.55 + 0.05);
}

TEST(Restitution, ARacketPassesOnItsSpeed) {
  // A stiff ball floats in the way of a plate that comes up at 1 m/s.
  World world = world_of("gravity = [0, 0, 0]\n" + ball("ball", "position = [0, 0.1, 0]", 1e7, 0) +
                         R"([[collider]]
name = "plate"
shape = { box = { extent = [1, 0.1, 1] } }
position = [0, -0.05, 0]
restitution = 0.7
ease = "linear"
keys = [{ t = 0 }, { t = 1, move = [0, 1, 0] }]
)");
  for (int frame = 0; frame < 20; ++frame) EXPECT_TRUE(world.play(frame));
  EXPECT_NEAR(velocity(world, 0).y(), 1.7, 0.05);
}

TEST(Restitution, WhatRestsStaysAsItIs) {
  const auto cubes = [](double restitution) {
    std::string text = ground;
    for (int i = 0; i < 3; ++i)
      text += fmt::format(R"([[body]]
name = "cube{}"
box = {{ extent = [0.2, 0.2, 0.2], cells = [2, 2, 2] }}
position = [0, {}, 0]
material = {{ model = "stable-neo-hookean", young = 1e5, poisson = 0.4 }}
contact = {{ restitution = {} }}
)",
                          i, 0.2 * i, restitution);
    return text;
  };
  World with = world_of(cubes(0.9)), without = world_of(cubes(0));
  for (int frame = 0; frame < 30; ++frame) {
    EXPECT_TRUE(with.play(frame));
    EXPECT_TRUE(without.play(frame));
  }
  EXPECT_EQ(with.hash(), without.hash());
}

TEST(Restitution, BitsDependNeitherOnThreadsNorOnWhereAFilmWasResumed) {
  const std::string text = "fps = 120\n" + ground +
                           ball("low", "position = [0, 0.05, 0]\nvelocity = [0, -2, 0]", 2e4, 0.8) +
                           ball("high", "position = [0.05, 0.4, 0]\nvelocity = [0, -2, 0]", 2e4, 0.5) +
                           ball("far", "position = [2, 0.05, 0]\nvelocity = [0, -2, 0]", 2e4, 0.5) +
                           ball("away", "position = [4, 0.05, 0]\nvelocity = [0, -2, 0]", 2e4, 1);
  const auto play = [](World& world, int end) {
    std::vector<std::uint64_t> hashes;
    while (world.frames() < end) {
      EXPECT_TRUE(world.play(world.frames()));
      hashes.push_back(world.hash());
    }
    return hashes;
  };
  Threads one(1);
  World first = world_of(text, &one);
  const std::vector<std::uint64_t> hashes = play(first, 40);
  for (const int count : {2, 4}) {
    Threads threads(count);
    World other = world_of(text, &threads);
    EXPECT_EQ(play(other, 40), hashes) << count << " threads";
  }
  const test::TemporaryFolder folder;
  for (const int middle : {6, 9, 14, 22}) {
    World begun = world_of(text, &one);
    play(begun, middle);
    if (middle == 6) {
      EXPECT_FALSE(begun.body(0).state().bounces.begun.empty());
    }
    test::write_text(folder.path / "checkpoint", checkpoint_bytes(begun.state(), "{}"));
    World resumed = world_of(text, &one);
    resumed.restore(read_checkpoint(folder.path / "checkpoint", "{}"));
    EXPECT_EQ(play(resumed, 40), std::vector(hashes.begin() + middle, hashes.end())) << middle;
  }
}

TEST(Restitution, IsRefusedOfClothAndAboveOne) {
  const std::string cloth =
      "[[body]]\ncloth = { extent = [1, 1], cells = [4, 4] }\nmaterial = \"cotton\"\ncontact = { restitution = 0.5 }\n";
  EXPECT_EQ(
      test::problems_of(cloth),
      std::vector<std::string>{"scene.toml:4:11: contact.restitution is for solids: a cloth has no motion as a whole "
                               "that could bounce"});
  EXPECT_EQ(test::problems_of(ground + "restitution = 1.5\n" + ball("ball", "", 1e5, 0)),
            std::vector<std::string>{"scene.toml:4:15: restitution = 1.5: must be 0 to 1"});
}

}  // namespace restitution_test
}  // namespace supple
