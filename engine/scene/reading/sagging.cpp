#include "scene/reading/sagging.h"

#include <algorithm>
#include <cmath>

#include "sim/sim.h"

namespace supple {
namespace {

constexpr double collapsed = 4;  // times the wanted sag: a body that sinks further is not followed

// Says how a body is watched.
struct Watch {
  double time_step;  // [s]
  int steps;
  double speed;  // speed at which the body comes down when its sole is held [m/s]
};

BodyDescription standing_body(const TetMesh& mesh, const Sagging& sagging, double young, double time_step) {
  BodyDescription body;
  body.name = "model";
  body.mesh = mesh;
  body.mesh.regions.assign(std::size_t(mesh.tets.rows()), 0);
  body.materials = {NeoHookean::from(Lame::from_young(young, sagging.poisson))};
  body.density = sagging.density;
  body.time_step = time_step;
  const Bounds box = bounds_of(mesh.rest);
  Handle feet{"feet", {}, 0};
  for (std::int32_t v = 0; v < mesh.rest.rows(); ++v) {
    if (mesh.rest(v, 1) <= box.lower.y() + sagging.sole * box.extent().y()) feet.vertices.push_back(v);
  }
  body.handles.push_back(std::move(feet));
  return body;
}

// Returns the horizontal direction, of length 1, in which a body leans; a fixed one where it leans nowhere. A body is
// pushed that way, because perfect balance does not count as standing, and a push the other way might hold it up.
Vec3 leaning_direction(const Model& model, const State& state) {
  constexpr double upright = 1e-6;  // share of the size: less is no lean
  Vec3 way = (state.x - model.rest).colwise().mean().transpose();
  way.y() = 0;
  return way.norm() > upright * model.size ? way.normalized() : Vec3(1, 0, 1).normalized();
}

// Returns how far the place that sinks furthest has sunk at the end, over the height; at least `collapsed` times the
// wanted share where it has sunk as far at any time; 1 where a step fails.
double watched_sag(const TetMesh& mesh, const Sagging& sagging, double young, const Watch& watch) {
  constexpr double lean = 0.05;  // force to the side, over the weight
  const BodyDescription body = standing_body(mesh, sagging, young, watch.time_step);
  if (std::ssize(body.handles.front().vertices) == mesh.rest.rows()) return 0;
  const Model model = build_model(body);
  StepInputs inputs;
  inputs.targets.resize(std::ssize(model.handled), 3);
  for (std::size_t i = 0; i < model.handled.size(); ++i)
    inputs.targets.row(Eigen::Index(i)) = model.rest.row(model.handled[i].vertex);
  State state = rest_state(model);
  state.v.topRows(model.free).col(1).setConstant(-watch.speed);
  Workspace workspace;
  const double height = bounds_of(mesh.rest).extent().y();
  double sunk = 0;
  for (int number = 0; number < watch.steps && sunk < collapsed * sagging.share; ++number) {
    inputs.gravity = standard_gravity * (lean * leaning_direction(model, state) - Vec3::UnitY());
    if (step(model, inputs, state, workspace).failed) return 1;
    sunk = (model.rest.col(1) - state.x.col(1)).maxCoeff() / height;
  }
  return sunk;
}

}  // namespace

double sag_of(const TetMesh& mesh, const Sagging& sagging, double young) {
  return watched_sag(mesh, sagging, young,
                     {0.125, 24, 0});  // long steps damp what swings; losing balance takes a while
}

double young_for_sag(const TetMesh& mesh, const Sagging& sagging, double first_guess) {
  constexpr int most_trials = 9;
  constexpr double near = 0.2;     // accepted difference from the wanted sag, over that sag
  constexpr double stiffer = 2.5;  // factor where the body collapses, so that its sag says nothing
  // The search ends once both bounds of the modulus are within this factor: a body that buckles either hardly sags or
  // collapses, so that there may be no modulus with the wanted sag.
  constexpr double narrow = 1.3;
  const double height = bounds_of(mesh.rest).extent().y();
  // A column of this height with the same section everywhere sags as it should with this modulus.
  const double of_column = sagging.density * standard_gravity * height / (2 * sagging.share);
  double young = first_guess > 0 ? first_guess : of_column;
  double too_soft = 0, stiff_enough = 0;  // 0: none is known yet
  for (int trial = 0; trial < most_trials; ++trial) {
    const double ratio = sag_of(mesh, sagging, young) / sagging.share;
    if (std::abs(ratio - 1) < near) return young;
    (ratio > 1 ? too_soft : stiff_enough) = young;
    young *= ratio < collapsed ? std::max(0.2, ratio) : stiffer;
    if (too_soft == 0 || stiff_enough == 0) continue;
    if (stiff_enough < narrow * too_soft) break;
    if (young <= too_soft || young >= stiff_enough) young = std::sqrt(too_soft * stiff_enough);
  }
  return stiff_enough > 0 ? stiff_enough : young;
}

double young_for_fall(const TetMesh& mesh, const Sagging& sagging, double young, double height) {
  constexpr int most_trials = 6;
  constexpr double stiffer = 1.6;
  const Watch landing{1.0 / 30, 45, std::sqrt(2 * standard_gravity * height)};
  for (int trial = 0; trial < most_trials; ++trial) {
    if (watched_sag(mesh, sagging, young, landing) < 2 * sagging.share) break;
    young *= stiffer;
  }
  return young;
}

}  // namespace supple
