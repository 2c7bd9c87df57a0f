#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "app/bench/sections.h"
#include "baselines/system_matrix.h"
#include "film/plan/shipped_files.h"
#include "sim/solver/hessian_matrix.h"

namespace supple {
namespace {

using Dense = Eigen::MatrixXd;

// Returns the 24 rotations that map a cube onto itself.
std::vector<Mat3> cube_rotations() {
  std::vector<Mat3> rotations;
  std::array<int, 3> axes = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 r = Mat3::Zero();
      for (int i = 0; i < 3; ++i) r(i, axes[i]) = signs & (1 << i) ? -1 : 1;
      if (r.determinant() > 0) rotations.push_back(r);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return rotations;
}

// Returns a state at rest in which the body is stretched along x by `stretch` and then rotated, both about its middle.
BenchState released(const Subject& subject, double stretch, const Mat3& rotation) {
  BenchState state{0, start_state(subject.model(), subject.body()), 0};
  state.before.v.setZero();
  const Eigen::RowVector3d middle = subject.model().rest.colwise().mean();
  const Mat3 f = rotation * Vec3(stretch, 1, 1).asDiagonal();
  state.before.x = ((subject.model().rest.rowwise() - middle) * f.transpose()).rowwise() + middle;
  return state;
}

// Holds the condition number of A^-1 H, which is its largest eigenvalue over its smallest one, and the smallest
// eigenvalue.
struct Conditioning {
  double number, smallest;
};
Conditioning conditioning(const Dense& a, const Dense& h) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Dense> pencil(h, a, Eigen::EigenvaluesOnly);
  const Eigen::VectorXd& values = pencil.eigenvalues();
  return {values[values.size() - 1] / values[0], values[0]};
}

Dense dense_of(const SparseMatrix& lower) { return Dense(Dense(lower).selfadjointView<Eigen::Lower>()); }

// Returns M/h^2 + L for x, y and z together.
Dense ours_of(const Model& model) {
  const Dense one = Dense(system_matrix_of(model));
  Dense three = Dense::Zero(3 * model.free, 3 * model.free);
  for (int i = 0; i < model.free; ++i) {
    for (int j = 0; j < model.free; ++j) {
      for (int c = 0; c < 3; ++c) three(3 * i + c, 3 * j + c) = one(i, j);
    }
  }
  return three;
}

Dense hessian_at(const Subject& subject, const Positions& x) {
  ElementMatrices elements;
  HessianMatrix hessian(subject.model());
  element_matrices(subject.model(), nullptr, x, false, elements);
  hessian.assemble(subject.model(), elements, {}, x);
  return dense_of(hessian.matrix());
}

// Adds figure 9 to the section, and how far the errors of the cube in other poses are from those in the first one.
// quarter: the turn of pose 2.
void add_figure9(const BenchSetting& setting, Subject& subject, double stretch, const Mat3& quarter,
                 ReportSection& section) {
  SolverComparison comparison(subject, *setting.threads);
  const std::vector<SolverEntry> both = {{"ours", Method::quasi_newton, 30},
                                         {"rest pose", Method::lbfgs_from(StartMatrix::rest_hessian), 30}};
  ReportPlot plot{"figure9", "Error by iteration in both poses"};
  plot.x_label = "iteration";
  plot.y_label = "error (equation 12)";
  plot.y_min = 1e-12;
  plot.y_max = 2;
  double spread[2] = {0, 0};
  std::vector<double> first_curve[2];
  for (const Mat3& rotation : cube_rotations()) {
    const BenchState state = released(subject, stretch, rotation);
    const std::vector<Outcome> outcomes = comparison.run(state, both, 0);
    const Minimum lowest = comparison.reference(state, outcomes);
    for (int m = 0; m < 2; ++m) {
      const std::vector<double> errors = errors_of(outcomes[m], lowest.below_y);
      if (first_curve[m].empty()) first_curve[m] = errors;
      for (std::size_t k = 0; k < std::min(errors.size(), first_curve[m].size()) && k <= 10; ++k) {
        if (std::min(errors[k], first_curve[m][k]) < 1e-12) break;  // round-off
        spread[m] = std::max(spread[m], std::abs(std::log10(errors[k] / first_curve[m][k])));
      }
      const bool shown = rotation.isIdentity() || rotation.isApprox(quarter);
      if (!shown) continue;
      PlotSeries curve{fmt::format("{}, pose {}", outcomes[m].label, rotation.isIdentity() ? 1 : 2)};
      curve.thick = m == 0 && rotation.isIdentity();
      curve.dashed = !rotation.isIdentity();
      for (std::size_t k = 0; k < errors.size() && errors[k] > 1e-13; ++k) {
        curve.x.push_back(static_cast<double>(k));
        curve.y.push_back(errors[k]);
      }
      plot.series.push_back(curve);
    }
  }
  ReportTable turns{"figure9-turns", "24 rotations of the cube"};
  turns.columns = {"initial Hessian", "largest difference of log10(error), 10 iterations"};
  turns.rows = {{"ours", number_text(spread[0])}, {"rest pose", number_text(spread[1])}};
  section.tables.push_back(std::move(turns));
  section.plots.push_back(std::move(plot));
}

}  // namespace

ReportSection bench_table2(const BenchSetting& setting) {
  constexpr double stretch = 1.2;
  Subject subject({(assets_folder() / "bench" / "cube.toml").string(), "cube"});
  const Mat3 quarter = Eigen::AngleAxisd(std::acos(-1) / 2, Vec3::UnitZ()).toRotationMatrix();
  const BenchState as_it_is = released(subject, stretch, Mat3::Identity());
  const BenchState turned = released(subject, stretch, quarter);
  const Dense rest = hessian_at(subject, subject.model().rest), ours = ours_of(subject.model());
  const Dense first = hessian_at(subject, as_it_is.before.x), second = hessian_at(subject, turned.before.x);

  ReportSection section{"table2", "Table II and figure 9: a cube near rest, and the same turned"};
  section.text = fmt::format(
      "A free cube ({}, mass 0.5, mu = lambda = 80, Neo-Hookean, h = 1/30 s), stretched along x by {:g} and let go; "
      "pose 2 "
      "is pose 1 turned by 90 degrees about z. The paper does not give its parameters; these bring the first three "
      "numbers near its own. Condition number: largest over smallest eigenvalue of A^-1 H with H the exact Hessian at "
      "the start.",
      subject.size_text(), stretch);
  ReportTable table{"table2", "Condition numbers"};
  table.columns = {"initial Hessian", "pose", "condition number", "smallest eigenvalue", "paper"};
  const auto add = [&](const char* name, const char* pose, const Dense& a, const Dense& h, double paper) {
    const Conditioning c = conditioning(a, h);
    table.rows.push_back({name, pose, number_text(c.number, 9), number_text(c.smallest), number_text(paper)});
  };
  add("rest pose", "1", rest, first, 2.45);
  add("rest pose", "2, turned", rest, second, 45.5);
  add("ours", "1", ours, first, 9.94);
  add("ours", "2, turned", ours, second, 9.94);
  section.tables.push_back(std::move(table));

  add_figure9(setting, subject, stretch, quarter, section);
  return section;
}

}  // namespace supple
