// Compares bodies that fly into each other with what symmetry, momentum and energy allow, and finds out whether linked
// rings stay linked when one is thrown.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/linked_rings.h"
#include "app/bench/sections.h"
#include "app/bench/subject.h"
#include "app/bench/touching_film.h"
#include "app/bench/touching_tables.h"
#include "scene/building/assemble.h"

namespace supple {
namespace {

// Returns the text of a cube of 0.2 m without friction, whose centre is level with the origin.
std::string flying_cube(const char* name, double x, double speed) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }}\nposition = [{:g}, -0.1, 0]\n"
      "velocity = [{:g}, 0, 0]\nmaterial = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\n"
      "density = 1000\ncontact = {{ friction = 0 }}\n",
      name, x, speed);
}

constexpr const char* middle_wall = "[[collider]]\nname = \"wall\"\nshape = { half_space = { normal = [-1, 0, 0] } }\n";

// Returns the mirror image of a mesh at the plane x = 0.
TetMesh mirrored(TetMesh mesh) {
  mesh.rest.col(0) *= -1;
  mesh.tets.col(0).swap(mesh.tets.col(1));
  return mesh;
}

struct HeadOn {
  double difference = 0;          // of positions, over the size
  double speed = 0, at_wall = 0;  // after the impact [m/s]
  double momentum = 0;            // change of the sum, over what was exchanged
  double angular = 0;             // change of the sum, over one cube's momentum times its size
  double energy = 0;              // the most above the start, over that at the start
  int failed = -1;                // frame
};

HeadOn head_on(double speed, int substeps, Threads& threads) {
  constexpr int frames = 60;
  const std::string head = fmt::format("frames = {}\nsubsteps = {}\ngravity = [0, 0, 0]\n", frames, substeps);
  const SceneDef pair =
      scene_of_text(head + flying_cube("left", -0.25, speed) + flying_cube("right", 0.25, -speed), "two cubes");
  std::vector<Body> bodies = assemble(pair);
  bodies[1].description.mesh = mirrored(bodies[0].description.mesh);
  TouchingFilm two(pair, std::move(bodies), threads);
  TouchingFilm one(head + flying_cube("left", -0.25, speed) + middle_wall, threads);
  const Vec3 momentum = two.momentum(), angular = two.angular_momentum();
  const double energy = two.energy(), of_one = two.momentum(0).norm(), size = two.size(0);
  HeadOn result;
  double exchanged = 0, changed = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const Vec3 left = two.momentum(0);
    if (!two.play() || !one.play()) {
      result.failed = frame;
      return result;
    }
    exchanged += (two.momentum(0) - left).norm();
    changed = std::max(changed, (two.momentum() - momentum).norm());
    result.difference = std::max(result.difference, (two.places(0) - one.places(0)).rowwise().norm().maxCoeff() / size);
    result.angular = std::max(result.angular, (two.angular_momentum() - angular).norm() / (of_one * size));
    result.energy = std::max(result.energy, two.energy() / energy - 1);
  }
  result.momentum = exchanged > 0 ? changed / exchanged : std::nan("");
  result.speed = 0.5 * (two.velocity(0).norm() + two.velocity(1).norm());
  result.at_wall = one.velocity(0).norm();
  return result;
}

std::string ring_text(const char* name, double height, double turn_deg, double speed, double young, const char* keys) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nshape = \"shapes/ring.toml\"\nscale = 0.25\nvertices = 400\nposition = [0, {:g}, 0]\n"
      "turn_deg = [0, {:g}, 0]\nvelocity = [0, {:g}, 0]\n"
      "material = {{ model = \"stable-neo-hookean\", young = {:g}, poisson = 0.4 }}\n{}\n",
      name, height, turn_deg, speed, young, keys);
}

// Throws the lower one of two linked rings down, whose upper one is held at its top. Returns how it ended.
std::string thrown_ring(double speed, double young, int substeps, Threads& threads) {
  constexpr int frames = 30;
  TouchingFilm film(fmt::format("frames = {}\nsubsteps = {}\ngravity = [0, 0, 0]\n", frames, substeps) +
                        ring_text("held", 1, 0, 0, young,
                                  "[[body.handles]]\nname = \"hook\"\nselect = { box = [[0, 0.85, 0], [1, 1, 1]] }") +
                        ring_text("thrown", 0.71, 90, -speed, young, ""),
                    threads);
  const auto line = [&film](std::size_t body) {
    return middle_line_of_ring(film.world().bodies()[body].description.mesh.rest, film.places(body));
  };
  for (int frame = 0; frame < frames; ++frame) {
    if (!film.play()) return fmt::format("step failed in frame {}", frame);
    if (std::abs(std::abs(linking_number(line(0), line(1))) - 1) > 1e-3) return fmt::format("apart in frame {}", frame);
  }
  return "linked";
}

}  // namespace

ReportTable head_on_table(const BenchSetting& setting) {
  ReportTable table{"touching-head-on", "Two cubes that meet head-on, beside one at a wall in the middle"};
  table.note =
      "Cubes of 0.2 m with 5 x 5 x 5 vertices, stable Neo-Hookean, 1e5 Pa, Poisson's ratio 0.4, 1000 kg/m^3, without "
      "friction and gravity; 60 frames. The right cube is the mirror image of the left one, its mesh too. The "
      "difference is the largest of all positions of the left cube from those of the cube at the wall, over the cube's "
      "diagonal. The change of momentum is over what the cubes exchange, that of "
      "angular momentum over one cube's momentum times its diagonal; energy is kinetic and elastic, the most above "
      "its value at the start. Backward Euler takes energy away, so it may well be negative after the start.";
  table.columns = {"speed [m/s]",
                   "steps a frame",
                   "difference from the wall [%]",
                   "difference, aim: below [%]",
                   "leaves at [m/s]",
                   "leaves the wall at [m/s]",
                   "change of momentum",
                   "momentum, aim: below",
                   "change of angular momentum",
                   "angular momentum, aim: below",
                   "energy above the start [%]",
                   "energy, aim: below [%]",
                   "failed in frame"};
  for (const double speed : {2.0, 8.0}) {
    for (const int substeps : {1, 2, 4, 8}) {
      say_doing(setting, fmt::format("two cubes at {:g} m/s, {} steps a frame", speed, substeps));
      const HeadOn result = head_on(speed, substeps, *setting.threads);
      table.rows.push_back({number_text(speed), std::to_string(substeps), number_text(100 * result.difference), "1",
                            number_text(result.speed, 4), number_text(result.at_wall, 4), number_text(result.momentum),
                            "1e-12", number_text(result.angular), "1e-3", number_text(100 * result.energy), "1",
                            result.failed < 0 ? "" : std::to_string(result.failed)});
    }
  }
  return table;
}

ReportTable linked_rings_table(const BenchSetting& setting) {
  ReportTable table{"touching-rings", "Two linked rings: one is held, the other is thrown away from it"};
  table.note =
      "Rings of radius 0.25 m with 400 vertices, stable Neo-Hookean, Poisson's ratio 0.4, 1000 kg/m^3, without "
      "gravity; "
      "30 frames. Rings are linked for as long as their middle lines go around each other once (the linking number by "
      "Gauss' integral). The aim is that they stay linked. A wave along a rod goes at sqrt(E / density), 14 m/s with "
      "2e5 Pa: a ring that is faster cannot be stopped as a whole by what holds it.";
  table.columns = {"speed [m/s]", "Young's modulus [Pa]", "1 step a frame", "4 steps a frame", "aim"};
  for (const double young : {2e5, 2e6}) {
    for (const double speed : {1.0, 4.0, 8.0, 12.0, 16.0, 20.0}) {
      say_doing(setting, fmt::format("linked rings at {:g} m/s, {:g} Pa", speed, young));
      table.rows.push_back({number_text(speed), number_text(young), thrown_ring(speed, young, 1, *setting.threads),
                            thrown_ring(speed, young, 4, *setting.threads), "linked"});
    }
  }
  return table;
}

}  // namespace supple
