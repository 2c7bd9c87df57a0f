// Plays cloth beside Bullet's and beside the paper's springs, on the same grids with the same masses: a sheet that
// hangs by two corners, and one that falls on a ball. It prints markdown. Bullet has the settings that bullet_world.h
// names. Usage: supple_bullet_cloth_study
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "app/bench/comparison.h"
#include "app/bench/touching_film.h"
#include "base/timing.h"
#include "scene/building/assemble.h"
#include "studies/bullet_world.h"

using namespace supple;

namespace {

constexpr double warp = 1200, shear = 15, bend = 1.2e-5;  // cotton [N/m], [N/m], [N m]
constexpr double density = 0.124;                         // [kg/m^2]
constexpr double radius = 0.25, friction = 0.4;           // of the ball [m]
constexpr double patience_ms = 60'000;                    // for a film in Bullet
constexpr double usual_stretch = 30;                      // of springs in Bullet's examples [N/m]

// Describes what is played with a square sheet of 1 m.
struct Case {
  const char* name;
  const char* place;  // lines of the body
  bool hangs;
};

constexpr Case cases[] = {{"hangs by two corners", "turn_deg = [-90, 0, 0]\n", true},
                          {"falls on a ball", "turn_deg = [-90, 0, 0]\nposition = [0, 0.3, 0]\n", false}};

std::string text_of(const Case& of, int cells, int substeps, bool springs) {
  std::string text = fmt::format("frames = 120\nsubsteps = {}\n[[body]]\nname = \"sheet\"\n{}", substeps, of.place);
  text += "contact = { self = false }\n";
  // A spring beside another one carries the width of a cell.
  text += springs ? fmt::format(
                        "cloth = {{ extent = [1, 1], cells = [{}, {}], stretch = {:g}, shear = {:g}, bend = {:g} }}\n"
                        "total_mass = {:g}\n",
                        cells, cells, warp, shear, bend * cells * cells, density)
                  : fmt::format(
                        "cloth = {{ extent = [1, 1], cells = [{}, {}] }}\ndensity = {:g}\n"
                        "material = {{ model = \"woven\", warp = {:g}, shear = {:g}, bend = {:g} }}\n",
                        cells, cells, density, warp, shear, bend);
  if (of.hangs) {
    text += "[[body.handles]]\nname = \"left\"\nselect = { box = [[0, 1, 0], [0, 1, 1]] }\n";
    text += "[[body.handles]]\nname = \"right\"\nselect = { box = [[1, 1, 0], [1, 1, 1]] }\n";
  } else {
    text += fmt::format("[[collider]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = {:g} }} }}\nfriction = {:g}\n",
                        radius, friction);
  }
  return text;
}

// Returns how much longer the edges along the grid are than at rest, at the 99th percentile and at most.
std::pair<double, double> stretches(const Positions& x, int cells) {
  std::vector<double> all;
  const double rest = 1.0 / cells;
  const auto at = [&](int i, int j) { return x.row(i + (cells + 1) * j); };
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      all.push_back((at(i + 1, j) - at(i, j)).norm() / rest);
      all.push_back((at(j, i + 1) - at(j, i)).norm() / rest);
    }
  }
  return {rank_of(all, 0.99), rank_of(all, 1)};
}

// Returns the share of the flat sheet's area that its shadow on the floor has.
double shadow(const Positions& x, const Triangles& triangles) {
  constexpr int pixels = 400;
  constexpr double width = 1.6;  // of the floor that is looked at [m]
  const Vec3 middle = x.colwise().mean().transpose();
  std::vector<char> dark(std::size_t(pixels) * pixels, 0);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    double u[3], v[3];
    for (int k = 0; k < 3; ++k) {
      u[k] = ((x(triangles(t, k), 0) - middle.x()) / width + 0.5) * pixels;
      v[k] = ((x(triangles(t, k), 2) - middle.z()) / width + 0.5) * pixels;
    }
    const auto [u_low, u_high] = std::minmax({u[0], u[1], u[2]});
    const auto [v_low, v_high] = std::minmax({v[0], v[1], v[2]});
    const auto side = [&](int a, int b, double px, double py) {
      return (u[b] - u[a]) * (py - v[a]) - (v[b] - v[a]) * (px - u[a]);
    };
    for (int j = std::max(0, int(v_low)); j <= std::min(pixels - 1, int(v_high)); ++j) {
      for (int i = std::max(0, int(u_low)); i <= std::min(pixels - 1, int(u_high)); ++i) {
        const double a = side(0, 1, i + 0.5, j + 0.5), b = side(1, 2, i + 0.5, j + 0.5),
                     c = side(2, 0, i + 0.5, j + 0.5);
        if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0)) dark[std::size_t(j) * pixels + i] = 1;
      }
    }
  }
  return double(std::ranges::count(dark, 1)) * width * width / (double(pixels) * pixels);
}

// Returns how deep a vertex is inside the ball at most [m].
double deepest(const Positions& x) { return std::max(0.0, radius - x.rowwise().norm().minCoeff()); }

struct Result {
  std::vector<double> ms, kinetic, stretch, deep;
  Positions last;
  std::string end = "whole";
};

void note_frame(const Positions& x, int cells, double ms, double kinetic, Result& result) {
  result.ms.push_back(ms);
  result.kinetic.push_back(kinetic);
  result.stretch.push_back(stretches(x, cells).first);
  result.deep.push_back(deepest(x));
  result.last = x;
}

void print(const Case& of, int cells, const std::string& program, const Triangles& triangles, const Result& result) {
  if (result.ms.empty())
    return fmt::print("| {}, {} cells | {} | | | | | | {} |\n", of.name, cells, program, result.end);
  const std::string drape = of.hangs ? fmt::format("lowest {:.3f} m", result.last.col(1).minCoeff())
                                     : fmt::format("shadow {:.2f}", shadow(result.last, triangles));
  fmt::print("| {}, {} cells | {} | {:.3g}, {:.3g} | {:.3f}, {:.3f} | {} | {} | {:.1e} | {} |\n", of.name, cells,
             program, rank_of(result.ms, 0), rank_of(result.ms, 0.5), rank_of(result.stretch, 0.5),
             rank_of(result.stretch, 1), drape, of.hangs ? "" : fmt::format("{:.2g}", 1000 * rank_of(result.deep, 1)),
             result.kinetic.back() / *std::ranges::max_element(result.kinetic), result.end);
}

void play_supple(const Case& of, int cells, int substeps, bool springs, Threads& threads) {
  const std::string text = text_of(of, cells, substeps, springs);
  const std::vector<Body> bodies = assemble(scene_of_text(text, "sheet"));
  TouchingFilm film(text, threads);
  Result result;
  while (film.frames() < 120 && film.play())
    note_frame(film.places(0), cells, film.work().ms, film.kinetic_energy(), result);
  print(of, cells, fmt::format("supple, {}, {} a frame", springs ? "springs" : "woven", substeps),
        bodies[0].cloth.surface.triangles, result);
}

void play_bullet(const Case& of, int cells, double margin, double stretch) {
  const std::vector<Body> bodies = assemble(scene_of_text(text_of(of, cells, 1, false), "sheet"));
  const Triangles& triangles = bodies[0].cloth.surface.triangles;
  const Positions x = first_positions(bodies[0]);
  std::vector<double> mass(std::size_t(x.rows()), 0.0);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) mass[std::size_t(triangles(t, k))] += density / (6.0 * cells * cells);
  }
  std::vector<int> held;
  for (const Handle& handle : bodies[0].description.handles)
    held.insert(held.end(), handle.vertices.begin(), handle.vertices.end());
  BulletWorld world(Vec3(0, -9.81, 0), margin);
  world.add_cloth(x, triangles, mass, stretch, bend * cells * cells, held, friction);
  if (!of.hangs) world.add_obstacle(std::make_unique<btSphereShape>(btScalar(radius)), Vec3::Zero(), friction);
  Result result;
  const Stopwatch whole;
  for (int frame = 0; frame < 120; ++frame) {
    if (whole.elapsed_ms() > patience_ms) {
      result.end = fmt::format("given up after {} frames", frame);
      break;
    }
    const Stopwatch watch;
    world.play();
    const double ms = watch.elapsed_ms();
    const Positions now = world.places()[0];
    if (!now.allFinite() || bounds_of(now).diagonal() > 30) {
      result.end = fmt::format("torn in frame {}", frame);
      break;
    }
    note_frame(now, cells, ms, world.kinetic_energy(), result);
  }
  print(of, cells, fmt::format("Bullet, {:g} N/m, 8 a frame, margin {:g} mm", stretch, 1000 * margin), triangles,
        result);
}

}  // namespace

int main() {
  Threads threads(1);
  fmt::print(
      "| sheet of 1 m | program | ms a frame: least, median | edges over rest, 99th percentile: median frame, worst | "
      "at "
      "the end | deepest vertex [mm] | kinetic energy at the end over its most | "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const Case& of : cases) {
    constexpr double margin = 0.015;  // [m]
    for (const int cells : {20, 40}) {
      for (const int substeps : {1, 8})
        for (const bool springs : {false, true}) play_supple(of, cells, substeps, springs, threads);
      for (const double stretch : {warp, usual_stretch}) play_bullet(of, cells, margin, stretch);
    }
  }
}
