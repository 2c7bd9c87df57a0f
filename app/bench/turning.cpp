// Compares films of bodies that turn with the same films whose every step is solved. The paper's matrix
// resists a turn as it resists a strain, so a few quasi-Newton iterations turn a stiff body too little. Such a body
// hardly deforms, so this shows in its motion as a whole: a ball that rolls too slowly, a bar that falls too late.
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string_view>

#include "app/bench/sections.h"
#include "app/bench/turning_films.h"
#include "base/stretches.h"
#include "scene/definition/rotation.h"

namespace supple {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double friction = 0.5;

struct Substance {
  std::string name, keys;  // keys of a body's table
};

Substance preset(const std::string& name) { return {name, fmt::format("material = \"{}\"\n", name)}; }

Substance substance_of(const std::string& model, double young, double poisson, double density) {
  return {fmt::format("{}, {:.0e} Pa", model, young),
          fmt::format("material = {{ model = \"{}\", young = {:g}, poisson = {:g} }}\ndensity = {:g}\n", model, young,
                      poisson, density)};
}

// Returns rubber of any stiffness, which nearly keeps its volume.
Substance stiff_rubber(double young) { return substance_of("stable-neo-hookean", young, 0.45, 1100); }
Substance stiff_corotated(double young) { return substance_of("corotated", young, 0.4, 1000); }

std::string plane(const Vec3& normal) {
  return fmt::format("[[collider]]\nshape = {{ half_space = {{ normal = {} }} }}\nfriction = {:g}\n", list_text(normal),
                     friction);
}

// Returns the rotation that takes the body nearest from rest to x, by masses.
Mat3 rotation_of(const Model& model, const Positions& x) {
  const Vec3 center = mass_mean(model, x), rest_center = mass_mean(model, model.rest);
  Mat3 sum = Mat3::Zero();
  for (int v = 0; v < model.vertices; ++v)
    sum += model.mass[std::size_t(v)] * (x.row(v).transpose() - center) * (model.rest.row(v) - rest_center.transpose());
  return nearest_rotation(sum);
}

// Returns the angle by which a rotation turns about the z axis, clockwise as a ball that rolls along x does [degrees].
double rolled_angle(const Mat3& rotation) {
  return std::atan2(rotation(0, 1) - rotation(1, 0), rotation(0, 0) + rotation(1, 1)) / degree;
}

// Balls.

constexpr double ball_radius = 0.1;  // [m]
constexpr int usual_ball = 1000;     // vertices
// Without these two sizes, which take most of the time, the table still has every material.
constexpr std::array other_balls = {300, 4000};

struct Ball {
  Substance substance;
  int vertices;
};

std::vector<Ball> balls(std::span<const int> other_sizes) {
  std::vector<int> sizes = {usual_ball};
  sizes.insert(sizes.end(), other_sizes.begin(), other_sizes.end());
  std::vector<Ball> list;
  for (const int vertices : sizes) {
    for (const char* name : {"jelly", "flesh", "rubber"}) list.push_back({preset(name), vertices});
    for (const double young : {1e7, 1e8, 1e9}) list.push_back({stiff_rubber(young), vertices});
  }
  return list;
}

// Returns the text of a scene of a ball, without what it rolls on. center: the place of its centre at the start.
std::string ball_text(const Ball& ball, int frames, const Vec3& center, double speed) {
  return fmt::format(
      "frames = {}\n[[body]]\nname = \"ball\"\nshape = \"shapes/sphere.toml\"\nscale = {:g}\nvertices = {}\nposition = "
      "{}\nvelocity = [{:g}, 0, 0]\n{}",
      frames, ball_radius, ball.vertices, list_text(center - ball_radius * Vec3::UnitY()), speed, ball.substance.keys);
}

std::string name_of(const Ball& ball) { return fmt::format("{}, {} vertices", ball.substance.name, ball.vertices); }

ReportTable roll_table(std::span<const int> other_sizes, const BenchSetting& setting) {
  constexpr double speed = 1;  // [m/s]
  ReportTable table = table_of("turning-roll", "A ball that slides at first, and rolls after", {"material"},
                               {{"speed", "m/s", "% of the first"}, {"angle", "degrees", "degrees"}});
  table.note =
      fmt::format("Radius {:g} m, {:g} m/s along the ground, friction {:g}; 12 frames.", ball_radius, speed, friction);
  for (const Ball& ball : balls(other_sizes)) {
    TurningCase rolling;
    rolling.scene = ball_text(ball, 12, ball_radius * Vec3::UnitY(), speed) + plane(Vec3::UnitY());
    rolling.observe = [](const Model& model, const State& state) {
      return Vec3(mass_mean(model, state.v).x(), rolled_angle(rotation_of(model, state.x)), 0);
    };
    const TurningFilms films = play_films(rolling, "rolling ball: " + name_of(ball), setting);
    const MotionCurves speeds = curves_of(films, 0), angles = without_jumps(curves_of(films, 1));
    TableCells row = {ball.substance.name};
    append(row, cells_of(speeds, constant_unit(speeds, speed / 100)));
    append(row, cells_of(angles, constant_unit(angles, 1)));
    append(row, costs_of(films));
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable slope_table(std::span<const int> other_sizes, const BenchSetting& setting) {
  constexpr double slope_deg = 10;
  const Vec3 normal(std::sin(slope_deg * degree), std::cos(slope_deg * degree), 0), down(normal.y(), -normal.x(), 0);
  ReportTable table = table_of("turning-slope", "A ball that starts to roll down a slope", {"material"},
                               {{"speed", "m/s", "% of the solved last one"}});
  table.note = fmt::format("Radius {:g} m, at rest at the start, {:g} degrees, friction {:g}; 15 frames.", ball_radius,
                           slope_deg, friction);
  for (const Ball& ball : balls(other_sizes)) {
    TurningCase rolling;
    rolling.scene = ball_text(ball, 15, ball_radius * normal, 0) + plane(normal);
    rolling.observe = [down](const Model& model, const State& state) {
      return Vec3(mass_mean(model, state.v).dot(down), 0, 0);
    };
    const TurningFilms films = play_films(rolling, "ball on a slope: " + name_of(ball), setting);
    const MotionCurves speeds = curves_of(films, 0);
    TableCells row = {ball.substance.name};
    append(row, cells_of(speeds, constant_unit(speeds, std::abs(last_of(speeds.solved)) / 100)));
    append(row, costs_of(films));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// A cube that topples.

std::string cube_text(const Substance& substance, std::string_view keys) {
  return fmt::format("[[body]]\nname = \"cube\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [6, 6, 6] }}\n{}{}", keys,
                     substance.keys);
}

// Returns the smallest angle between an axis of the cube, whichever points up, and the vertical [degrees].
double tilt(const Mat3& rotation) { return std::acos(std::min(rotation.row(1).cwiseAbs().maxCoeff(), 1.0)) / degree; }

// Returns the number of frames after which the cube first lies on a face; empty: it never does.
std::string frames_until_flat(const MotionCurve& tilts) {
  constexpr double flat = 2;  // [degrees]
  for (Eigen::Index k = 0; k < tilts.size(); ++k) {
    if (tilts[k] < flat) return std::to_string(k);
  }
  return "";
}

ReportTable topple_table(const BenchSetting& setting) {
  const Vec3 turn_deg(30, 0, 20);
  const Mat3 first_turn = rotation_from_degrees(turn_deg).toRotationMatrix();
  ReportTable table = table_of("turning-topple", "A cube that falls on a corner, and topples onto a face",
                               {"material", "ours, frames until below 2 degrees",
                                "paper's, frames until below 2 degrees", "solved, frames until below 2 degrees"},
                               {{"tilt", "degrees", "degrees"}});
  table.note = fmt::format(
      "Edge 0.2 m, turned by {} degrees, from 2 cm above the ground, friction {:g}; 30 frames. The tilt is the "
      "smallest angle between an axis of the cube and the vertical.",
      list_text(turn_deg), friction);
  for (const Substance& substance : {preset("rubber"), stiff_rubber(1e9)}) {
    TurningCase toppling;
    toppling.scene =
        "frames = 30\n" +
        cube_text(substance, fmt::format("position = [0, 0.02, 0]\nturn_deg = {}\n", list_text(turn_deg))) +
        plane(Vec3::UnitY());
    toppling.observe = [first_turn](const Model& model, const State& state) {
      return Vec3(tilt(rotation_of(model, state.x) * first_turn), 0, 0);
    };
    const TurningFilms films = play_films(toppling, "toppling cube: " + substance.name, setting);
    const MotionCurves tilts = curves_of(films, 0);
    TableCells row = {substance.name, frames_until_flat(tilts.ours), frames_until_flat(tilts.papers),
                      frames_until_flat(tilts.solved)};
    append(row, cells_of(tilts, constant_unit(tilts, 1)));
    append(row, costs_of(films));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Bars.

// Returns a hard handle. box: the corners of the box that it holds, relative to the body's box at rest.
std::string held(const char* box) {
  return fmt::format("[[body.handles]]\nname = \"held\"\nselect = {{ box = {} }}\n", box);
}

// Returns a bar of one metre along x. Its cells are cubes. across: the number of cells across the bar.
std::string bar_text(double thickness, int across, const Substance& substance) {
  return fmt::format("[[body]]\nname = \"bar\"\nbox = {{ extent = [1, {0:g}, {0:g}], cells = [{1}, {2}, {2}] }}\n{3}",
                     thickness, std::lround(across / thickness), across, substance.keys);
}

// Returns the present place of one end of the body: the mean of the vertices that lie furthest in a direction at rest.
Vec3 tip_of(const Model& model, const Positions& x, const Vec3& direction) {
  const Eigen::VectorXd along = model.rest * direction;
  const double end = along.maxCoeff() - 1e-6 * model.size;
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int v = 0; v < model.vertices; ++v) {
    if (along[v] < end) continue;
    sum += x.row(v).transpose();
    ++count;
  }
  return sum / count;
}

Vec3 middle_of_held(const Model& model) {
  Vec3 sum = Vec3::Zero();
  for (const Model::HandleVertex& held_vertex : model.handled) sum += model.rest.row(held_vertex.vertex).transpose();
  return sum / double(model.handled.size());
}

// Returns the angle below the horizontal of the line from the hinge to the far end [degrees].
double swung_angle(const Model& model, const State& state) {
  const Vec3 line = tip_of(model, state.x, Vec3::UnitX()) - middle_of_held(model);
  return std::atan2(-line.y(), line.x()) / degree;
}

ReportTable swing_table(const BenchSetting& setting) {
  ReportTable table = table_of("turning-swing", "A bar that swings on a hinge or on a single vertex",
                               {"held", "material"}, {{"angle", "degrees", "degrees"}});
  table.note =
      "1 m x 0.05 m x 0.05 m, level at the start; 15 frames. A hinge is the lower edge of one end; a pin is the vertex "
      "in the middle of that end.";
  const std::array<std::pair<const char*, const char*>, 2> ways = {
      {{"hinge", "[[0, 0, 0], [0, 0, 1]]"}, {"pin", "[[0, 0.5, 0.5], [0, 0.5, 0.5]]"}}};
  for (const auto& [way, box] : ways) {
    for (const double young : {5e6, 1e8, 1e9, 1e10}) {
      const Substance substance = stiff_corotated(young);
      TurningCase swinging;
      swinging.scene = "frames = 15\n" + bar_text(0.05, 2, substance) + held(box);
      swinging.observe = [](const Model& model, const State& state) { return Vec3(swung_angle(model, state), 0, 0); };
      const TurningFilms films =
          play_films(swinging, fmt::format("swinging bar, {}: {}", way, substance.name), setting);
      const MotionCurves angles = without_jumps(curves_of(films, 0));
      TableCells row = {way, substance.name};
      append(row, cells_of(angles, constant_unit(angles, 1)));
      append(row, costs_of(films));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

struct Cantilever {
  std::string form;
  Substance substance;
  std::string body;                // the text of the body and its handle
  Vec3 end_along = Vec3::UnitX();  // from its middle towards the tip, at rest
};

Cantilever straight_bar(double slenderness, int across, double young) {
  const Substance substance = stiff_corotated(young);
  return {fmt::format("straight, slenderness {:g}", slenderness), substance,
          bar_text(1 / slenderness, across, substance) + held("[[0, 0, 0], [0, 1, 1]]")};
}

// Returns a bar of a shape file. Its elements do not lie in layers, so that the handle reaches in by about one of them.
Cantilever shaped_bar(const std::string& form, const std::string& file, const Vec3& end_along, double young) {
  const Substance substance = stiff_corotated(young);
  return {form, substance,
          fmt::format("[[body]]\nname = \"bar\"\nshape = \"bench/{}\"\nvertices = 1000\n{}{}", file, substance.keys,
                      held("[[0, 0, 0], [0.03, 1, 1]]")),
          end_along};
}

std::vector<Cantilever> cantilevers() {
  std::vector<Cantilever> list;
  for (const double young : {1e5, 1e6, 1e7, 1e8, 1e9}) list.push_back(straight_bar(12.5, 3, young));
  list.push_back(straight_bar(5, 3, 1e7));
  for (const double slenderness : {20.0, 50.0}) list.push_back(straight_bar(slenderness, 2, 1e7));
  list.push_back(shaped_bar("bent", "bent-bar.toml", Vec3::UnitZ(), 1e7));
  list.push_back(shaped_bar("forked", "forked-bar.toml", Vec3(1, 0, 1), 1e7));
  return list;
}

// Returns one percent of the way that the solved tip has gone, frame by frame [m].
MotionCurve percent_of_way(const TurningFilm& solved) {
  constexpr double least_way = 1e-4;  // [m]; a percent of a shorter way is too small to be seen
  MotionCurve unit(Eigen::Index(solved.seen.size()));
  double way = 0;
  for (std::size_t k = 0; k < solved.seen.size(); ++k) {
    if (k > 0) way += (solved.seen[k] - solved.seen[k - 1]).norm();
    unit[Eigen::Index(k)] = std::max(least_way, way) / 100;
  }
  return unit;
}

ReportTable clamped_table(const BenchSetting& setting) {
  ReportTable table = table_of("turning-clamped", "A bar that is clamped at one end and let go", {"form", "material"},
                               {{"height of the tip", "m", "% of its way so far"}});
  table.note =
      "1 m long, level at the start; 12 frames. The bent bar turns to the side by a right angle, the forked one has "
      "two arms. Differences are shares of the way that the solved tip has gone so far, which counts as at least 0.1 "
      "mm.";
  for (const Cantilever& bar : cantilevers()) {
    TurningCase falling;
    falling.scene = "frames = 12\n" + bar.body;
    falling.observe = [along = bar.end_along](const Model& model, const State& state) {
      return tip_of(model, state.x, along);
    };
    const TurningFilms films =
        play_films(falling, fmt::format("clamped bar, {}: {}", bar.form, bar.substance.name), setting);
    TableCells row = {bar.form, bar.substance.name};
    append(row, cells_of(curves_of(films, 1), percent_of_way(films.solved)));
    append(row, costs_of(films));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Free bodies that spin.

// Returns the angular momentum about the centre of mass [kg m^2/s].
Vec3 angular_momentum(const Model& model, const State& state) {
  const Vec3 center = mass_mean(model, state.x), velocity = mass_mean(model, state.v);
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < model.vertices; ++v)
    sum +=
        model.mass[std::size_t(v)] * (state.x.row(v).transpose() - center).cross(state.v.row(v).transpose() - velocity);
  return sum;
}

std::string creature_text(const Substance& substance) {
  return "[[body]]\nname = \"creature\"\nshape = \"shapes/blob.toml\"\nsize = 0.2\nvertices = 500\n" + substance.keys;
}

ReportTable spin_table(const BenchSetting& setting) {
  const Vec3 spin(1, 6, 0.5);  // [rad/s]
  ReportTable table = table_of("turning-spin", "A free body that spins", {"body", "material"},
                               {{"angular momentum", "of the first", "%"}});
  table.note = fmt::format(
      "0.2 m, without gravity, {} rad/s at the start; 30 frames. Backward Euler itself takes angular momentum away: "
      "the solved film says how much.",
      list_text(spin));
  for (const Substance& substance :
       {preset("rubber"), preset("wood"), stiff_corotated(1e6), substance_of("neo-hookean", 1e7, 0.4, 1000)}) {
    const std::array<std::pair<const char*, std::string>, 2> bodies = {
        {{"cube", cube_text(substance, "")}, {"creature", creature_text(substance)}}};
    for (const auto& [name, text] : bodies) {
      TurningCase spinning;
      spinning.scene = "frames = 30\ngravity = [0, 0, 0]\n" + text;
      spinning.observe = [](const Model& model, const State& state) {
        return Vec3(angular_momentum(model, state).norm(), 0, 0);
      };
      spinning.spin = spin;
      const TurningFilms films = play_films(spinning, fmt::format("spinning {}: {}", name, substance.name), setting);
      const MotionCurves momenta = over_first(curves_of(films, 0));
      TableCells row = {name, substance.name};
      append(row, cells_of(momenta, momenta.solved / 100));
      append(row, costs_of(films));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace

ReportSection bench_turning(const BenchSetting& setting) {
  ReportSection section{"turning", "Bodies that turn"};
  section.text =
      "Each case is filmed four times from the same start, with h = 1/30 s: \"ours\" as a scene is solved that says "
      "nothing of its solver, with ten iterations a step, and more where it is far; \"paper's\" with ten that start "
      "as the paper's do; \"solved\" with 200 iterations a step, and once more with 400. One number tells how far the "
      "body has come. The tables have the worst difference of all frames from the solved film, and the number itself "
      "at the end.\n\n"
      "Films go their own ways: a difference is what all steps so far have left, not the error of one. The film that "
      "is solved again tells how far two solved films come apart: a stiff ball of facets slides or sticks by next to "
      "nothing. The last column tells how well the worst step of the solved film is solved.";
  section.tables = {roll_table(other_balls, setting),
                    slope_table(other_balls, setting),
                    topple_table(setting),
                    swing_table(setting),
                    clamped_table(setting),
                    spin_table(setting)};
  return section;
}

}  // namespace supple
