// Plays bodies that rest on each other: a block on a soft slope, and a stack of cubes.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/bench/sections.h"
#include "app/bench/touching_film.h"
#include "app/bench/touching_tables.h"

namespace supple {
namespace {

constexpr double gravity = 9.81, slope_angle = 20 * std::numbers::pi / 180;
constexpr int film_rate = 30;  // frames a second

// Returns the scene of a block on a slab whose underside is held. The slab lies level and gravity is turned, so that
// the slope goes down along x.
std::string block_on_slab(double friction, int substeps, int frames) {
  const auto body = [friction](const char* name, const char* box, const char* position, const char* keys) {
    return fmt::format(
        "[[body]]\nname = \"{}\"\nbox = {}\nposition = {}\ncontact = {{ friction = {:g} }}\n"
        "material = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\ndensity = 1000\n{}\n",
        name, box, position, friction, keys);
  };
  return fmt::format("frames = {}\nsubsteps = {}\nfps = {}\ngravity = [{:.17g}, {:.17g}, 0]\n", frames, substeps,
                     film_rate, gravity * std::sin(slope_angle), -gravity * std::cos(slope_angle)) +
         body("slab", "{ extent = [1.4, 0.1, 0.4], cells = [28, 2, 8] }", "[0, 0, 0]",
              "[[body.handles]]\nname = \"back\"\nselect = { box = [[0, 0, 0], [1, 0.01, 1]] }") +
         body("block", "{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }", "[-0.5, 0.1001, 0]", "");
}

constexpr std::size_t block = 1;  // the number of the body in that scene

struct OnSlope {
  double creep = 0;  // in the last of three seconds [sizes/s]
  double share = 0;  // of Coulomb's acceleration, from 0.3 to 0.8 s
  double depth = 0;  // the deepest, over the block's size
  bool failed = false;
};

OnSlope sticks(double friction, int substeps, Threads& threads) {
  constexpr int frames = 3 * film_rate;
  TouchingFilm film(block_on_slab(friction, substeps, frames), threads);
  OnSlope result;
  double place = 0;
  for (int frame = 0; frame < frames; ++frame) {
    if (frame == 2 * film_rate) place = film.center(block).x();
    if (!film.play()) return {.failed = true};
    for (const double depth : film.work().depths) result.depth = std::max(result.depth, depth);
  }
  result.creep = (film.center(block).x() - place) / film.size(block);
  return result;
}

OnSlope slides(double friction, int substeps, Threads& threads) {
  constexpr int first = 3 * film_rate / 10, last = 8 * film_rate / 10;
  TouchingFilm film(block_on_slab(friction, substeps, last), threads);
  OnSlope result;
  double speed = 0;
  for (int frame = 0; frame < last; ++frame) {
    if (frame == first) speed = film.velocity(block).x();
    if (!film.play()) return {.failed = true};
    for (const double depth : film.work().depths) result.depth = std::max(result.depth, depth);
  }
  const double acceleration = (film.velocity(block).x() - speed) * film_rate / (last - first);
  result.share = acceleration / (gravity * (std::sin(slope_angle) - friction * std::cos(slope_angle)));
  return result;
}

std::string stacked_cubes(int count, int frames) {
  std::string text = fmt::format("frames = {}\nfps = {}\n", frames, film_rate);
  for (int i = 0; i < count; ++i) {
    text += fmt::format(
        "[[body]]\nname = \"cube-{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }}\n"
        "position = [0, {:g}, 0]\nmaterial = {{ model = \"stable-neo-hookean\", young = 1e6, poisson = 0.4 }}\n"
        "density = 1000\n",
        i + 1, 0.001 + 0.201 * i);
  }
  return text + ground_text(0.5);
}

}  // namespace

ReportTable soft_slope_table(const BenchSetting& setting) {
  ReportTable table{"touching-slope", "A block on a soft slope of 20 degrees"};
  table.note =
      "Both are stable Neo-Hookean with 1e5 Pa and Poisson's ratio 0.4. The block is a cube of 0.2 m, the slope a slab "
      "of 0.1 m that is held at its back. With a coefficient of 0.5 Coulomb's law keeps the block where it is: it "
      "creeps by so many of its diagonals a second in the third second. With 0.2 it slides with g (sin - mu cos): "
      "the acceleration is that between 0.3 and 0.8 s.";
  table.columns = {"coefficient",
                   "steps a frame",
                   "creeps [diagonals/s]",
                   "creep, aim: below [diagonals/s]",
                   "acceleration over Coulomb's",
                   "acceleration, aim: 1 within",
                   "deepest [%]",
                   "depth, aim: below [%]"};
  for (const double friction : {0.5, 0.2}) {
    for (const int substeps : {1, 4}) {
      say_doing(setting, fmt::format("block on a slope, coefficient {:g}, {} steps a frame", friction, substeps));
      const bool holds = friction > std::tan(slope_angle);
      const OnSlope result =
          holds ? sticks(friction, substeps, *setting.threads) : slides(friction, substeps, *setting.threads);
      const auto number = [&result](double value) { return result.failed ? "failed" : number_text(value); };
      table.rows.push_back({number_text(friction), std::to_string(substeps), holds ? number(result.creep) : "",
                            holds ? "1e-3" : "", holds ? "" : number(result.share), holds ? "" : "0.05",
                            number(100 * result.depth), "1"});
    }
  }
  return table;
}

ReportTable stack_table(const BenchSetting& setting) {
  constexpr int cubes = 5, seconds = 10, frames = seconds * film_rate;
  say_doing(setting, "a stack of five cubes");
  TouchingFilm film(stacked_cubes(cubes, frames), *setting.threads);
  bool failed = !film.play_until(frames / 2);
  std::vector<Positions> half_way;
  for (std::size_t b = 0; b < cubes; ++b) half_way.push_back(film.places(b));
  std::vector<double> deepest(cubes, 0.0);  // of each interface, by the cube above it, over the size
  while (!failed && film.frames() < frames) {
    failed = !film.play();
    for (const BodyTouch& touch : film.world().touches())
      deepest[touch.b] = std::max(deepest[touch.b], touch.depth / film.size(touch.b));
  }
  ReportTable table{"touching-stack", "A stack of five cubes, after ten seconds"};
  table.note =
      "Cubes of 0.2 m, stable Neo-Hookean with 1e6 Pa and Poisson's ratio 0.4, on ground with friction 0.5. The drift "
      "of a cube is the longest way between a vertex now and five seconds before, over the diagonal; the weight is the "
      "force from the cube below, in weights of one cube; the depth is the deepest of the last five seconds.";
  table.columns = {"cube",
                   "drift in 5 s [diagonals]",
                   "drift, aim: below [diagonals]",
                   "carried by the cube below [cubes]",
                   "weight, aim: within 1 % of [cubes]",
                   "deepest in the cube below [%]",
                   "depth, aim: below [%]"};
  for (std::size_t b = 0; b < cubes; ++b) {
    const double drift = (film.places(b) - half_way[b]).rowwise().norm().maxCoeff() / film.size(b);
    std::vector<std::string> row = {
        std::to_string(b + 1), failed ? "failed" : number_text(drift), "1e-3", "", "", "", ""};
    if (b > 0) {
      double carried = 0;  // the sum of forces up, from all cubes that lie lower
      for (const BodyTouch& touch : film.world().touches()) carried += touch.b == b ? touch.force.y() : 0;
      row[3] = number_text(carried / (film.world().body(b).model().total_mass * gravity), 5);
      row[4] = std::to_string(cubes - b);
      row[5] = number_text(100 * deepest[b]);
      row[6] = "0.5";
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace supple
