// Plays one hard case with one material.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/bench/case_text.h"
#include "app/bench/comparison.h"
#include "app/bench/sections.h"
#include "app/bench/stability_matrix.h"
#include "baselines/reference.h"
#include "output/run/row_tally.h"
#include "scene/building/warnings.h"
#include "scene/definition/rotation.h"
#include "sim/measures/energies.h"
#include "sim/measures/measures.h"
#include "sim/model/motion_error.h"
#include "sim/solver/first_iterate.h"

namespace supple {
namespace {

constexpr double much_motion = 0.05;  // error of motion of a step
constexpr double much_volume = 0.05, far_apart = 1e-3;

}  // namespace

// A body at rest may keep some stretch: the strain limits have no force up to 1.05, and the polynomial hardly any.
bool StabilityOutcome::is_at_rest() const {
  constexpr double rest_stretch = 1.06;
  return finite && inverted == 0 && collapsed == 0 && stretch <= rest_stretch;
}

namespace {

// Names the rule that an outcome breaks; empty: none.
std::string broken_rule(const StabilityOutcome& outcome, const HardCase& hard) {
  if (!outcome.finite) return "not finite";
  if (outcome.from_nothing > much_energy)
    return fmt::format("{:.0f} % energy from nothing", 100 * outcome.from_nothing);
  if (hard.end != StableEnd::bounded && outcome.inverted > 0) return fmt::format("{} inverted", outcome.inverted);
  if (hard.end != StableEnd::bounded && outcome.collapsed > 0)
    return fmt::format("{} without volume", outcome.collapsed);
  if (hard.end == StableEnd::recovered && !outcome.is_at_rest()) return fmt::format("stretch {:.2f}", outcome.stretch);
  if (outcome.volume_change > much_volume)
    return fmt::format("volume changed by {:.0f} %", 100 * outcome.volume_change);
  if (outcome.motion_error > much_motion) return fmt::format("motion {:.0f} % off", 100 * outcome.motion_error);
  if (outcome.turned_apart > far_apart) return fmt::format("turned copies {:.1e} apart", outcome.turned_apart);
  return "";
}

double volume_of(const Positions& x, const Tetrahedra& tets) {
  double sum = 0;
  for (Eigen::Index t = 0; t < tets.rows(); ++t) {
    const Eigen::RowVector3d a = x.row(tets(t, 1)) - x.row(tets(t, 0)), b = x.row(tets(t, 2)) - x.row(tets(t, 0)),
                             c = x.row(tets(t, 3)) - x.row(tets(t, 0));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

// Adds a copy of the whole mesh beside it, with vertices of its own.
void add_second_part(BodyDescription& body) {
  TetMesh& mesh = body.mesh;
  const Eigen::Index n = mesh.rest.rows(), m = mesh.tets.rows();
  const Bounds box = bounds_of(mesh.rest);
  mesh.rest.conservativeResize(2 * n, 3);
  mesh.tets.conservativeResize(2 * m, 4);
  mesh.rest.bottomRows(n) = mesh.rest.topRows(n).rowwise() + Eigen::RowVector3d(0, 0, 1.5 * box.extent().z());
  mesh.tets.bottomRows(m) = mesh.tets.topRows(m).array() + std::int32_t(n);
  if (!mesh.regions.empty()) mesh.regions.resize(std::size_t(2 * m), mesh.regions.front());
}

// Gives the half of the body at the larger x another material, or makes one half denser by masses at its vertices.
void make_halves_differ(BodyDescription& body, const HardCase& hard, std::vector<Material> materials) {
  TetMesh& mesh = body.mesh;
  const double middle = bounds_of(mesh.rest).center().x();
  mesh.regions.assign(std::size_t(mesh.tets.rows()), 0);
  // At a ratio below 1 the near half is the denser one.
  const double added = body.density * (hard.far_density > 1 ? hard.far_density - 1 : 0);
  const bool has_masses = hard.far_density != 1;
  if (has_masses) body.point_mass.assign(std::size_t(mesh.rest.rows()), 0.0);
  if (hard.far_density < 1) body.density *= hard.far_density;
  const double near_added = hard.far_density < 1 ? body.density / hard.far_density - body.density : 0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    double x = 0;
    for (int c = 0; c < 4; ++c) x += mesh.rest(mesh.tets(t, c), 0) / 4;
    const bool is_far = x > middle;
    mesh.regions[std::size_t(t)] = is_far ? 1 : 0;
    for (int c = 0; has_masses && c < 4; ++c)
      body.point_mass[std::size_t(mesh.tets(t, c))] += (is_far ? added : near_added) * tet_volume(mesh, t) / 4;
  }
  body.materials = std::move(materials);
  if (!body.fibres.empty()) body.fibres.resize(2, body.fibres.front());
}

// Gives all vertices velocities of a rigid turn about the centre of mass.
State spinning(const Model& model, State state, double turns_a_second, const Mat3& turn) {
  const Vec3 axis = turn * Vec3(1, 1, 1).normalized() * (2 * std::numbers::pi * turns_a_second);
  Vec3 center = Vec3::Zero();
  double mass = 0;
  for (int v = 0; v < model.vertices; ++v) {
    center += model.mass[std::size_t(v)] * state.x.row(v).transpose();
    mass += model.mass[std::size_t(v)];
  }
  center /= mass;
  for (int v = 0; v < model.vertices; ++v)
    state.v.row(v) += axis.cross(state.x.row(v).transpose() - center).transpose();
  return state;
}

// Tells whether a material's energy depends on J itself. The energies of the corotated model and of St.
// Venant-Kirchhoff depend on traces of strains, which are the change of volume only for small strains.
bool knows_volume(const std::string& material) { return material != "corotated" && material != "st-venant-kirchhoff"; }

// Tells how one run of a case differs from its scene's text.
struct Variation {
  int seed = 1;
  Vec3 turn_deg = Vec3::Zero();
};

// Holds the step that had the worst error estimate.
struct WorstStep {
  int frame = 0;
  State before;
};

class HardRun {
 public:
  HardRun(const HardCase& hard, const NamedMaterial& material, const Variation& variation, Threads& threads)
      : hard_(hard),
        keeps_volume_(hard.keeps_volume && knows_volume(material.name)),
        turn_(rotation_from_degrees(variation.turn_deg).toRotationMatrix()),
        scene_(scene_of_case(text(hard, table_of(hard, material, 1), variation, turn_))),
        world_(scene_, prepared(material, variation)) {
    world_.start(scenes_own_solver(), &threads);
    if (hard.turns_a_second > 0) body().restore(spinning(model(), body().state(), hard.turns_a_second, turn_));
  }

  StabilityOutcome play(std::vector<Positions>* motion, WorstStep* worst);
  TabledErrors errors_of(const WorstStep& worst);

 private:
  static std::string table_of(const HardCase& hard, const NamedMaterial& material, double stiffer) {
    if (!hard.only.empty()) return hard.only;
    return material_table(material.name, stiffer * hard.stiffness * usual_young, hard.poisson).value();
  }
  static std::string text(const HardCase& hard, const std::string& table, const Variation& variation,
                          const Mat3& turn) {
    std::string text = filled(hard.scene, "MATERIAL", table);
    text = filled(text, "SEED", std::to_string(variation.seed));
    text = filled(text, "TURN", list_text(variation.turn_deg));
    return filled(text, "GRAVITY", list_text(turn * Vec3(0, -9.81, 0)));
  }
  std::vector<Body> prepared(const NamedMaterial& material, const Variation& variation) const {
    std::vector<Body> bodies = assemble(scene_);
    Body& body = bodies.front();
    if (hard_.has_second_part) add_second_part(body.description);
    if (hard_.far_stiffness == 1 && hard_.near_stiffness == 1 && hard_.far_density == 1) return bodies;
    std::vector<Material> materials;
    for (const double stiffer : {hard_.near_stiffness, hard_.far_stiffness}) {
      const SceneDef scene = scene_of_case(text(hard_, table_of(hard_, material, stiffer), variation, turn_));
      materials.push_back(scene.bodies.front().substance.material);
    }
    make_halves_differ(body.description, hard_, std::move(materials));
    return bodies;
  }
  MovingBody& body() { return world_.body(0); }
  const MovingBody& body() const { return world_.body(0); }
  const Model& model() const { return body().model(); }
  // Returns the error of motion of the body's last step, which began at `before`, against the lowest minimum that is
  // found from where many more iterations end, or from where the step ended.
  double motion_error_of_step(const State& before);
  // Tells whether the program warns of the body's material before the film.
  bool is_material_warned_of() const {
    return std::ranges::any_of(warnings(scene_, world_.bodies()),
                               [](const Warning& warning) { return warning.kind == WarningKind::material; });
  }
  // Returns the positions in the body's own frame: turned back, about the mean of its rest positions.
  Positions turned_back() const {
    const Positions rest = in_input_order(model(), model().rest), x = in_input_order(model(), body().state().x);
    return (x.rowwise() - rest.colwise().mean()) * turn_;
  }

  const HardCase& hard_;
  bool keeps_volume_;
  Mat3 turn_;
  SceneDef scene_;
  World world_;
  OpenWorkspace solving_;
};

double HardRun::motion_error_of_step(const State& before) {
  constexpr int many = 200;
  StepInputs inputs = body().inputs();
  inputs.solver.iterations = many;
  State after = before;
  supple::step(model(), inputs, after, solving_);
  Reference reference(model());
  Positions y;
  inertial_prediction(model(), inputs, before, y);
  const Positions& x = body().state().x;
  const Minimum solved = reference.minimum(model(), inputs, before, after.x, solving_);
  const double error = motion_error(model(), before.x, y, x, solved.x);
  if (error <= much_motion) return error;
  const Minimum own = reference.minimum(model(), inputs, before, x, solving_);
  return own.below_y > solved.below_y ? motion_error(model(), before.x, y, x, own.x) : error;
}

StabilityOutcome HardRun::play(std::vector<Positions>* motion, WorstStep* worst) {
  StabilityOutcome outcome;
  OpenWorkspace& workspace = body().workspace();
  workspace.prepare(model(), body().inputs().solver);
  EnergyBudget budget;
  budget.start(model(), body().inputs(), body().state(), workspace);
  const Tetrahedra& tets = body().body().description.mesh.tets;
  const double volume = volume_of(body().body().description.mesh.rest, tets);
  outcome.start = in_input_order(model(), body().state().x);
  bool unsolved = false;
  State before;
  const StepWatch watch{[&](std::size_t, int) {
                          if (!budget.knows_springs())
                            budget.know_springs(model(), body().targets_at_start(), body().seams_at_start(),
                                                body().state());
                          budget.before_step(model(), body().inputs(), body().state(), workspace);
                          before = body().state();
                        },
                        {}};
  for (int frame = 0; frame < scene_.frames && outcome.finite; ++frame) {
    outcome.finite = world_.play(frame, watch) && body().state().x.allFinite();
    if (!outcome.finite) break;
    const StepReport& report = body().report();
    if (body().untangled()) {
      budget.after_untangling(model(), body().inputs(), body().state(), workspace);
    } else {
      budget.after_step(model(), body().inputs(), before.x, body().state(), workspace);
    }
    const EnergyBalance& balance = budget.balance();
    if (balance.exchanged() > 0)
      outcome.from_nothing = std::max(outcome.from_nothing, balance.from_nothing / balance.exchanged());
    if (worst != nullptr && (frame == 0 || report.error_estimate > outcome.error_estimate)) *worst = {frame, before};
    outcome.error_estimate = std::max(outcome.error_estimate, report.error_estimate);
    if (hard_.follows_solution) outcome.motion_error = std::max(outcome.motion_error, motion_error_of_step(before));
    outcome.trials += double(report.line_search) / scene_.frames;
    unsolved = unsolved || is_unsolved(report);
    if (keeps_volume_)
      outcome.volume_change = std::max(
          outcome.volume_change, std::abs(volume_of(in_input_order(model(), body().state().x), tets) / volume - 1));
    if (motion != nullptr) motion->push_back(turned_back());
  }
  const Deformation shape = deformation(model(), body().state().x);
  outcome.stretch = shape.stretch;
  outcome.inverted = shape.inverted;
  outcome.collapsed = shape.collapsed;
  outcome.told = !outcome.finite || outcome.from_nothing > much_energy || shape.inverted > 0 || shape.collapsed > 0 ||
                 unsolved || is_material_warned_of();
  outcome.end = in_input_order(model(), body().state().x);
  outcome.surface = boundary_faces(tets);
  return outcome;
}

// Returns the errors of the worst step where it is made again with several numbers of iterations, and by Newton's
// method. They are measured against the lowest of the minima that are found from where these runs end.
TabledErrors HardRun::errors_of(const WorstStep& worst) {
  body().restore(worst.before);
  world_.enter(worst.frame);
  world_.prepare(0);
  const StepInputs inputs = body().inputs();
  Reference reference(model());
  OpenWorkspace workspace;
  std::vector<Minimum> minima;
  const auto add = [&](const Solvers& solvers, int iterations) {
    const SolverDef& def = body().body().def.solver;
    StepInputs more = inputs;
    more.solver = solvers.settings(def.method, def.settings);
    more.solver.iterations = iterations;
    more.solver.rounds = 1;
    more.solver.still = 0;
    State after = worst.before;
    const auto rule = solvers.rule(def.method, model());
    const bool failed = step(model(), more, after, workspace, *rule).failed;
    Minimum minimum;
    if (!failed) minimum = reference.minimum(model(), inputs, worst.before, after.x, workspace);
    if (failed) minimum.below_end = std::nan("");
    minima.push_back(std::move(minimum));
  };
  for (const int iterations : tabled_iterations) add(scenes_own_solver(), iterations);
  add(solver_instead(Method::newton, 50), 50);
  double whole = 0;
  for (const Minimum& minimum : minima) whole = std::max(whole, minimum.below_y);
  const double noise = 2 * noise_of(model(), whole, worst.before.x.cwiseAbs().maxCoeff());
  const auto error = [&](const Minimum& minimum) -> std::optional<double> {
    if (!(whole > noise)) return std::nullopt;
    return (minimum.below_end + (whole - minimum.below_y)) / whole;
  };
  TabledErrors errors;
  for (std::size_t k = 0; k < tabled_iterations.size(); ++k) errors.ours[k] = error(minima[k]);
  errors.newton = error(minima.back());
  return errors;
}

// Returns the turn of a copy. Turns are spread over all directions; the first copy is not turned.
Vec3 turn_of_copy(int copy) {
  const auto part = [copy](double step) { return 360 * std::fmod(copy * step, 1.0); };
  return Vec3(part(0.618033988749895), part(0.754877666246693), part(0.569840290998053));
}

}  // namespace

std::vector<NamedMaterial> stability_materials() {
  std::vector<NamedMaterial> list;
  for (const char* name :
       {"corotated", "st-venant-kirchhoff", "neo-hookean", "mooney-rivlin", "fixed-corotated", "stable-neo-hookean",
        "as-rigid-as-possible", "polynomial", "spline A", "spline B", "strain-limiting"})
    list.push_back({name, material_table(name, usual_young, usual_poisson).value()});
  return list;
}

std::optional<std::string> material_table(const std::string& name, double young, double poisson) {
  const bool usual = poisson == usual_poisson;
  const double scale = young / usual_young;
  std::string model = fmt::format("model = \"{}\"", name);
  if (name == "as-rigid-as-possible" || name == "polynomial" || name == "strain-limiting") {
    if (!usual) return std::nullopt;
    if (name == "strain-limiting")
      return fmt::format("{{ {}, mu_1 = {:g}, low_1 = 0.95, high_1 = 1.05 }}", model, 1.5e4 * scale);
    return fmt::format("{{ {}, mu = {:g} }}", model, (name == "polynomial" ? 1e5 : 1.5e4) * scale);
  }
  if (name.starts_with("spline")) model = fmt::format("model = \"spline\", preset = \"{}\"", name.back());
  if (name == "mooney-rivlin" && poisson < 0.15) return std::nullopt;  // its lambda would be negative
  if (poisson <= 0.495) return fmt::format("{{ {}, young = {:g}, poisson = {:g} }}", model, young, poisson);
  double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  if (name == "mooney-rivlin")
    return fmt::format("{{ {}, mu_1 = {:g}, mu_2 = {:g}, lambda = {:g} }}", model, 0.8 * mu, 0.2 * mu,
                       lambda - 0.4 * mu);
  if (name == "stable-neo-hookean") {
    lambda += 5.0 / 6 * mu;
    mu *= 4.0 / 3;
  }
  return fmt::format("{{ {}, mu = {:g}, lambda = {:g} }}", model, mu, lambda);
}

std::vector<StabilityOutcome> run_case(const HardCase& hard, const NamedMaterial& material, Threads& threads,
                                       bool with_errors) {
  std::vector<StabilityOutcome> outcomes;
  if (hard.only.empty() && !material_table(material.name, usual_young, hard.poisson)) return outcomes;
  std::vector<Positions> first;  // motion of the first copy
  for (int number = 0; number < std::max(hard.seeds, hard.copies); ++number) {
    Variation variation;
    if (hard.copies > 0) variation.turn_deg = turn_of_copy(number);
    if (hard.copies == 0) variation.seed = number + 1;
    HardRun run(hard, material, variation, threads);
    std::vector<Positions> motion;
    WorstStep worst;
    const bool errors = with_errors && number == 0;
    StabilityOutcome outcome = run.play(hard.copies > 0 ? &motion : nullptr, errors ? &worst : nullptr);
    if (number == 0) first = motion;
    if (errors && outcome.finite) outcome.errors = run.errors_of(worst);
    for (std::size_t frame = 0; frame < std::min(motion.size(), first.size()); ++frame) {
      const double size = bounds_of(first.front()).diagonal();
      outcome.turned_apart =
          std::max(outcome.turned_apart, (motion[frame] - first[frame]).rowwise().norm().maxCoeff() / size);
    }
    outcome.failure = broken_rule(outcome, hard);
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

}  // namespace supple
