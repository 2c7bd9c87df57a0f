// Plays scenes of bodies that meet beside Bullet's deformable world, on the same meshes: two cubes that fly into each
// other, and creatures that fall into a box. It prints markdown. Bullet has the settings that bullet_world.h names.
// Usage: supple_bullet_study ASSETS
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>

#include "app/bench/comparison.h"
#include "app/bench/touching_film.h"
#include "base/timing.h"
#include "scene/building/assemble.h"
#include "scene/building/body_depths.h"
#include "studies/bullet_world.h"

using namespace supple;

namespace {

constexpr double side = 0.55;            // half of the box's width [m]
constexpr double patience_ms = 180'000;  // for a film in Bullet

// Returns how deep bodies are in each other at most, by their vertices, over the smaller one's size.
double deepest(const std::vector<Body>& bodies, const std::vector<Positions>& places) {
  double most = 0;
  for (const BodyDepth& pair : overlaps_of_bodies(bodies, places)) most = std::max(most, pair.share);
  return most;
}

bool is_finite(const std::vector<Positions>& places) {
  return std::ranges::all_of(places, [](const Positions& x) { return x.allFinite(); });
}

std::vector<Positions> places_of(const TouchingFilm& film, std::size_t bodies) {
  std::vector<Positions> all;
  for (std::size_t b = 0; b < bodies; ++b) all.push_back(film.places(b));
  return all;
}

std::string supple_text(int substeps) { return fmt::format("supple, {} a frame", substeps); }

struct Result {
  std::vector<double> ms, depth, kinetic;
  std::string end = "whole";
};

// Plays Bullet's world, and calls after() at the end of each frame.
Result play(BulletWorld& world, const std::vector<Body>& bodies, int frames, const std::function<void()>& after) {
  Result result;
  const Stopwatch whole;
  for (int frame = 0; frame < frames; ++frame) {
    if (whole.elapsed_ms() > patience_ms) {
      result.end = fmt::format("given up after {} frames", frame);
      break;
    }
    const Stopwatch watch;
    world.play();
    result.ms.push_back(watch.elapsed_ms());
    const std::vector<Positions> places = world.places();
    if (!is_finite(places)) {
      result.end = fmt::format("not finite in frame {}", frame);
      break;
    }
    for (std::size_t b = 0; b < places.size() && result.end == "whole"; ++b) {
      if (bounds_of(places[b]).diagonal() > 3 * bounds_of(bodies[b].description.mesh.rest).diagonal())
        result.end = fmt::format("torn in frame {}", frame);
    }
    result.depth.push_back(deepest(bodies, places));
    result.kinetic.push_back(world.kinetic_energy());
    after();
  }
  return result;
}

void print_times(const char* scene, const char* program, const Result& result, const std::string& more) {
  if (result.ms.empty()) {
    fmt::print("| {} | {} | | | | | {} |\n", scene, program, result.end);
    return;
  }
  const double peak = *std::ranges::max_element(result.kinetic);
  fmt::print("| {} | {} | {:.3g}, {:.3g} | {:.2g}, {:.2g} | {:.2g} | {} | {} |\n", scene, program,
             rank_of(result.ms, 0), rank_of(result.ms, 0.5), 100 * rank_of(result.depth, 0.5),
             100 * rank_of(result.depth, 1), result.kinetic.back() / peak, more, result.end);
}

std::string cube_text(const char* name, double x, double speed) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }}\nposition = [{:g}, -0.1, 0]\n"
      "velocity = [{:g}, 0, 0]\nmaterial = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\n"
      "density = 1000\ncontact = {{ friction = 0 }}\n",
      name, x, speed);
}

// Two cubes: how fast they leave, and what becomes of the momentum that they exchange.
void compare_head_on(double speed, Threads& threads) {
  constexpr int frames = 60;
  const std::string text =
      "frames = 60\ngravity = [0, 0, 0]\n" + cube_text("left", -0.25, speed) + cube_text("right", 0.25, -speed);
  const std::string name = fmt::format("two cubes at {:g} m/s", speed);
  const std::vector<Body> bodies = assemble(scene_of_text(text, "cubes"));
  const auto more = [&](const Vec3& left, const Vec3& right, double mass, double exchanged) {
    return fmt::format("leave at {:.3g} m/s, momentum {:.1e}", 0.5 * (left.norm() + right.norm()) / mass,
                       (left + right).norm() / exchanged);
  };
  for (const int substeps : {1, 8}) {
    TouchingFilm film(fmt::format("substeps = {}\n", substeps) + text, threads);
    Result result;
    Vec3 before = film.momentum(0);
    double exchanged = 0;
    for (int frame = 0; frame < frames && film.play(); ++frame) {
      result.ms.push_back(film.work().ms);
      result.depth.push_back(deepest(bodies, places_of(film, 2)));
      result.kinetic.push_back(film.kinetic_energy());
      exchanged += (film.momentum(0) - before).norm();
      before = film.momentum(0);
    }
    print_times(name.c_str(), supple_text(substeps).c_str(), result,
                more(film.momentum(0), film.momentum(1), before.norm() / film.velocity(0).norm(), exchanged));
  }
  for (const double margin : {0.002, 0.015}) {
    BulletWorld world(Vec3::Zero(), margin);
    world.add(bodies[0], Lame::from_young(1e5, 0.4), 1000, 0, Vec3(speed, 0, 0));
    world.add(bodies[1], Lame::from_young(1e5, 0.4), 1000, 0, Vec3(-speed, 0, 0));
    Vec3 before = world.momentum(0);
    double exchanged = 0;
    const Result result = play(world, bodies, frames, [&] {
      exchanged += (world.momentum(0) - before).norm();
      before = world.momentum(0);
    });
    print_times(name.c_str(), fmt::format("Bullet, 8 a frame, margin {:g} mm", 1000 * margin).c_str(), result,
                more(world.momentum(0), world.momentum(1), world.mass(0), exchanged));
  }
}

// Returns the bodies of the scene of the bowl, above a box.
std::string pile_text(const std::string& assets) {
  std::ifstream file(assets + "/scenes/bowl.toml");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text.resize(text.find("[[collider]]"));
  text += "[[collider]]\nname = \"ground\"\nshape = { half_space = { normal = [0, 1, 0] } }\nfriction = 0.5\n";
  for (const char* normal : {"[1, 0, 0]", "[-1, 0, 0]", "[0, 0, 1]", "[0, 0, -1]"}) {
    const Vec3 n(normal[1] == '1' ? 1 : normal[1] == '-' ? -1 : 0, 0, 0);
    const double z = n.x() != 0 ? 0 : normal[7] == '1' ? 1 : -1;
    text += fmt::format(
        "[[collider]]\nshape = {{ half_space = {{ normal = {} }} }}\nposition = [{:g}, 0, {:g}]\nfriction = 0.5\n"
        "visible = false\n",
        normal, -side * n.x(), -side * z);
  }
  return text;
}

void compare_pile(const std::string& assets, Threads& threads) {
  constexpr int frames = 150;
  const std::string text = pile_text(assets);
  const std::vector<Body> bodies = assemble(scene_of_text(text, "pile"));
  for (const int substeps : {1, 8}) {
    TouchingFilm film(fmt::format("substeps = {}\n", substeps) + text, threads);
    Result result;
    for (int frame = 0; frame < frames && film.play(); ++frame) {
      result.ms.push_back(film.work().ms);
      result.depth.push_back(deepest(bodies, places_of(film, bodies.size())));
      result.kinetic.push_back(film.kinetic_energy());
    }
    print_times("pile", supple_text(substeps).c_str(), result, "");
  }
  for (const double margin : {0.002, 0.015}) {
    BulletWorld world(Vec3(0, -9.81, 0), margin);
    for (const Body& body : bodies)
      world.add(body, Lame::from_young(1e5, 0.4) /* as in the scene */, body.description.density, 0.5, Vec3::Zero());
    const auto add_wall = [&](const Vec3& center, const Vec3& half) {
      world.add_obstacle(std::make_unique<btBoxShape>(vector_of(half)), center, 0.5);
    };
    add_wall(Vec3(0, -0.5, 0), Vec3(3, 0.5, 3));
    for (const double sign : {-1.0, 1.0}) {
      add_wall(Vec3(sign * (side + 0.5), 1, 0), Vec3(0.5, 3, 3));
      add_wall(Vec3(0, 1, sign * (side + 0.5)), Vec3(3, 3, 0.5));
    }
    const Result result = play(world, bodies, frames, [] {});
    print_times("pile", fmt::format("Bullet, 8 a frame, margin {:g} mm", 1000 * margin).c_str(), result, "");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: supple_bullet_study ASSETS\n");
    return 2;
  }
  Threads threads(1);
  fmt::print(
      "| scene | program | ms a frame: least, median | deepest vertex [% of size]: median, most | kinetic energy at "
      "the end "
      "over its most | | end |\n|---|---|---|---|---|---|---|\n");
  compare_head_on(2, threads);
  compare_head_on(8, threads);
  compare_pile(argv[1], threads);
}
