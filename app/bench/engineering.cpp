#include <fmt/core.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "app/bench/least_time.h"
#include "app/bench/sections.h"
#include "base/timing.h"
#include "baselines/figure_rules.h"
#include "output/run/profile.h"
#include "sim/measures/measures.h"
#include "sim/model/element_view.h"

namespace supple {
namespace {

// Computes energies and forces of a polynomial material element by element, as a straightforward program would: F, a
// singular value decomposition, the slopes of mu (s - 1)^4, and forces added to vertices. The numbers are of type T.
template <class T>
T plain_evaluation(const std::vector<ElementView>& elements, const Positions& x, double mu, std::vector<T>& force) {
  using Matrix = Eigen::Matrix<T, 3, 3>;
  using Vector = Eigen::Matrix<T, 3, 1>;
  std::fill(force.begin(), force.end(), T(0));
  T sum = 0;
  for (const ElementView& element : elements) {
    Matrix edges, inverse;
    for (int k = 0; k < 3; ++k)
      edges.col(k) = (x.row(element.corner[k + 1]) - x.row(element.corner[0])).transpose().cast<T>();
    for (int i = 0; i < 9; ++i) inverse(i / 3, i % 3) = static_cast<T>(element.field[i]);
    const Matrix f = edges * inverse;
    const Eigen::JacobiSVD<Matrix> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Vector s = svd.singularValues(), slope;
    Matrix u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0) {
      u.col(2) *= T(-1);
      s[2] *= T(-1);
    }
    const T volume = static_cast<T>(element.field[9]), stiffness = static_cast<T>(mu);
    for (int i = 0; i < 3; ++i) {
      const T d = s[i] - 1;
      sum += volume * stiffness * d * d * d * d;
      slope[i] = 4 * stiffness * d * d * d;
    }
    const Matrix nodal = volume * u * slope.asDiagonal() * svd.matrixV().transpose() * inverse.transpose();
    for (int k = 0; k < 3; ++k) {
      for (int c = 0; c < 3; ++c) {
        force[3 * element.corner[k + 1] + c] += nodal(c, k);
        force[3 * element.corner[0] + c] -= nodal(c, k);
      }
    }
  }
  return sum;
}

}  // namespace

ReportSection bench_ablation(const BenchSetting& setting) {
  const SubjectChoice ours{"squirrel", "polynomial"};
  const SubjectChoice choice = with_paper_mesh(setting, ours, "squirrel_modified.mesh").value_or(ours);
  Subject subject(choice);
  const Model& model = subject.model();
  const BenchState state = states_of(subject, {35}, setting).front();
  const auto& material = std::get<Polynomial>(model.materials.front());
  std::vector<ElementView> elements;
  for_each_element(model, [&](const ElementView& element) { elements.push_back(element); });
  std::vector<float> force_float(3 * std::size_t(model.vertices));
  std::vector<double> force(3 * std::size_t(model.vertices));
  const Positions& x = state.before.x;

  ReportSection section{"ablation", "From the published settings to ours"};
  ReportTable table{"ablation", "One evaluation of energies and forces"};
  table.columns = {"how", "time [ms]", "a tetrahedron [ns]", "times faster than the first", "energy [J]"};
  double first = 0;
  double energy = 0;
  const auto add = [&](const char* how, double ms) {
    if (first == 0) first = ms;
    table.rows.push_back({how, number_text(ms), number_text(1e6 * ms / static_cast<double>(elements.size())),
                          number_text(first / ms), number_text(energy, 8)});
  };
  const double mu = material.mu;
  add("a general SVD, one element after the other, double",
      least_ms(7, [&] { energy = plain_evaluation<double>(elements, x, mu, force); }));
  add("the same in float", least_ms(7, [&] { energy = plain_evaluation<float>(elements, x, mu, force_float); }));
  OpenWorkspace workspace;
  workspace.prepare(model, {});
  State at = state.before;
  begin_step(model, subject.inputs(state), at, workspace);
  workspace.current.x = x;
  energy = elastic_energy(model, workspace, x);
  add("ours: no SVD, elements side by side in vector registers, with inertia and gathering",
      least_ms(15, [&] { evaluate(model, workspace, workspace.current, Wanted::gradient); }));
  add("the same, energy alone", least_ms(15, [&] { energy = elastic_energy(model, workspace, x); }));
  section.tables.push_back(std::move(table));

  ReportTable steps{"ablation-steps", "A step of ten iterations"};
  steps.columns = {"how", "step, least [ms]", "step, median [ms]", "error"};
  const auto run = [&](const std::string& how, const SubjectChoice& variant, int threads) {
    Subject changed(variant);
    Threads own(threads);
    SolverComparison comparison(changed, own);
    const std::vector<Outcome> outcomes = comparison.run(state, {{"ours", Method::quasi_newton, 10}}, 15);
    const Minimum lowest = comparison.reference(state, outcomes);
    steps.rows.push_back({how, number_text(outcomes[0].step_ms), number_text(outcomes[0].median_ms),
                          number_text(last_error(outcomes[0], lowest.below_y))});
  };
  SubjectChoice with_double = choice;
  with_double.settings.emplace_back("solver.factor=double");
  run("factor in double, one thread", with_double, 1);
  run("factor in float, one thread", choice, 1);
  run("factor in float, two threads", choice, 2);
  section.tables.push_back(std::move(steps));
  section.text = fmt::format(
      "Squirrel, polynomial, frame {} ({}). The first row is what a straightforward program does for each tetrahedron; "
      "none of the rows below it is mathematics of the method. The energy shows that all compute the same; float's "
      "digits end where a line search needs them.",
      state.frame, subject.size_text());
  return section;
}

ReportSection bench_contact(const BenchSetting& setting) {
  Subject subject({"bunny-torus", "bunny"});
  const Model& model = subject.model();
  SolverComparison comparison(subject, *setting.threads);
  Triangles surface = boundary_faces(subject.body().description.mesh.tets);
  for (Eigen::Index i = 0; i < surface.size(); ++i) surface.data()[i] = model.internal_of[surface.data()[i]];
  struct Row {
    std::string label;
    std::vector<double> error = {}, depth = {}, ms = {}, trials = {};
    int inverted = 0;
  };
  const std::vector<SolverEntry> entries = {{"ours", Method::quasi_newton, 10},
                                            {.label = "the paper's: contacts in pairs", .maker = make_paper_rule},
                                            {"Newton, 1 iteration", Method::newton, 1},
                                            {"Newton, 5 iterations", Method::newton, 5}};
  std::vector<Row> rows;
  for (const SolverEntry& entry : entries) rows.push_back({entry.label});
  for (const BenchState& state : states_of(subject, {56, 64, 72, 80, 88}, setting)) {
    const StepInputs inputs = subject.inputs(state);
    const std::vector<Outcome> outcomes = comparison.run(state, entries, 3);
    const Minimum lowest = comparison.reference(state, outcomes);
    for (std::size_t m = 0; m < rows.size(); ++m) {
      rows[m].error.push_back(last_error(outcomes[m], lowest.below_y));
      rows[m].depth.push_back(
          penetration(subject.world.colliders().colliders, inputs.collider_motions, outcomes[m].x, surface) /
          model.size);
      rows[m].ms.push_back(outcomes[m].step_ms);
      rows[m].trials.push_back(outcomes[m].trials);
      rows[m].inverted += deformation(model, outcomes[m].x).inverted;
    }
  }
  ReportSection section{"contact", "Contact three ways (section 4.3)"};
  section.text = fmt::format(
      "Bunny through the torus, five states in contact ({}). Error is equation 12 with the contacts found at the point "
      "where it is evaluated. The paper's directions know contacts from the pairs of L-BFGS alone, which have the "
      "planes "
      "of the iteration that made them; its rule is the plain recursion, on one thread. Newton has the touching planes "
      "in its Hessian.",
      subject.size_text());
  ReportTable table{"contact", "Five states"};
  table.columns = {"how",
                   "error, mean",
                   "error, worst",
                   "penetration, worst [of the size]",
                   "step, mean of least [ms]",
                   "trials a step",
                   "inverted elements in all"};
  for (const Row& row : rows) {
    const Summary error = summary_of(row.error);
    table.rows.push_back({row.label, number_text(error.mean), number_text(error.worst),
                          number_text(summary_of(row.depth).worst), number_text(summary_of(row.ms).mean),
                          number_text(summary_of(row.trials).mean), std::to_string(row.inverted)});
  }
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace supple
