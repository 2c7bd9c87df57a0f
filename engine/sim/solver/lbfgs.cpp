#include "sim/solver/lbfgs.h"

#include <algorithm>
#include <array>

#include "sim/contact/contact_direction.h"
#include "sim/linear/linear_kernels.h"
#include "sim/model/vertex_chunks.h"
#include "sim/solver/iterate.h"
#include "sim/solver/open_workspace.h"
#include "sim/solver/step_clock.h"

namespace supple {
namespace {

constexpr int most_pairs = 128;
constexpr long numbers_a_chunk = 3L * vertices_a_chunk;

using Pointers = std::array<const double*, most_pairs>;
using Numbers = std::array<double, most_pairs>;

// Computes result[i] = a_i . b, chunk by chunk, so that the sums do not depend on threads.
void dot_all(const Model& model, OpenWorkspace& workspace, const Pointers& a, int count, const double* b,
             double* result) {
  if (count == 0) return;
  const int chunks = vertex_chunks(model);
  double* partial = workspace.partial.data();
  run_chunks(workspace.threads, chunks, long(model.free) * count, [&](int c) {
    linear_kernels().dots(a.data(), count, b, c * numbers_a_chunk, std::min(3L * model.free, (c + 1) * numbers_a_chunk),
                          partial + c * count);
  });
  std::fill(result, result + count, 0.0);
  for (int c = 0; c < chunks; ++c) {
    for (int i = 0; i < count; ++i) result[i] += partial[c * count + i];
  }
}

void add_all(const Model& model, OpenWorkspace& workspace, const Pointers& a, const double* factors, int count,
             double* r) {
  if (count == 0) return;
  run_chunks(workspace.threads, vertex_chunks(model), long(model.free) * count, [&](int c) {
    linear_kernels().add_scaled(a.data(), factors, count, r, c * numbers_a_chunk,
                                std::min(3L * model.free, (c + 1) * numbers_a_chunk));
  });
}

// Returns how far the step of a pair leads along a stiff direction.
double along_pair(const StiffDirection& stiff, const double* step) {
  const ContactStencil& stencil = stiff.stencil;
  Vec3 mean = stencil.weight[0] * Eigen::Map<const Vec3>(step + 3 * std::size_t(stencil.vertex[0]));
  for (int k = 1; k < stencil.free; ++k)
    mean += stencil.weight[k] * Eigen::Map<const Vec3>(step + 3 * std::size_t(stencil.vertex[k]));
  return mean.dot(stiff.axis);
}

// Holds what the contacts in force add to all pairs, t_i += K s_i.
class ContactPairs {
 public:
  ContactPairs(const Model& model, OpenWorkspace& w, const Pointers& s, int count) : correction_(w.correction) {
    find_stiff_directions(model, w.current.contacts, w.current.x, w.correction);
    directions_ = correction_.wanted.size();
    if (count == 0 || directions_ == 0) return;
    count_ = count;
    correction_.along.resize(directions_ * count);
    correction_.products.assign(std::size_t(count) * count, 0.0);
    for (std::size_t k = 0; k < directions_; ++k) {
      const StiffDirection& stiff = correction_.wanted[k];
      double* along = &correction_.along[k * count];
      for (int i = 0; i < count; ++i) along[i] = along_pair(stiff, s[i]);
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) correction_.products[i * count + j] += stiff.stiffness * along[i] * along[j];
      }
    }
  }

  // Returns s_i . K s_j.
  double product(int i, int j) const { return count_ > 0 ? correction_.products[i * count_ + j] : 0; }

  // Adds sum factor_i K s_i to r.
  void add(const double* factors, Positions& r) const {
    for (std::size_t k = 0; k < directions_; ++k) {
      const StiffDirection& stiff = correction_.wanted[k];
      double sum = 0;
      for (int i = 0; i < count_; ++i) sum += factors[i] * correction_.along[k * count_ + i];
      stiff.add(stiff.stiffness * sum, r);
    }
  }

  // Returns K s_i . z.
  double dot(int i, const Positions& z) const {
    if (count_ == 0) return 0;
    double sum = 0;
    for (std::size_t k = 0; k < directions_; ++k) {
      const StiffDirection& stiff = correction_.wanted[k];
      sum += stiff.stiffness * correction_.along[k * count_ + i] * stiff.along(z);
    }
    return sum;
  }

 private:
  ContactCorrection& correction_;
  int count_ = 0;
  std::size_t directions_ = 0;
};

}  // namespace

double search_direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace,
                        const PairHistory& history, InitialInverse& initial) {
  TimedPhase timed(workspace.clock, Phase::lbfgs, "L-BFGS");
  const int count = history.count;
  Pointers s{}, t{};
  for (int i = 0; i < count; ++i) {
    s[i] = workspace.step_pairs[history.place(i)].data();
    t[i] = workspace.gradient_pairs[history.place(i)].data();
  }
  const ContactPairs contacts(model, workspace, s, count);
  // Returns s_i . t_j of the i-th and j-th newest pairs.
  const auto product = [&](int i, int j) {
    return workspace.products[history.place(i) * history.window + history.place(j)] + contacts.product(i, j);
  };

  // The inner products of the recursion change as r and z do. Given the products of the pairs among themselves, one
  // pass over the vectors computes all of them, and one more pass applies the result.
  Positions& r = workspace.direction;
  r = workspace.current.gradient;
  Numbers alpha{}, against{}, factor{};
  dot_all(model, workspace, s, count, r.data(), against.data());
  for (int i = 0; i < count; ++i) {
    double left = against[i];
    for (int j = 0; j < i; ++j) left -= alpha[j] * product(i, j);
    alpha[i] = left / product(i, i);
    factor[i] = -alpha[i];
  }
  add_all(model, workspace, t, factor.data(), count, r.data());
  contacts.add(factor.data(), r);

  timed.next(Phase::solve, "solve");
  Positions& z = workspace.scratch;
  initial.apply(model, inputs, workspace, r, z);
  r = z;

  timed.next(Phase::lbfgs, "L-BFGS");
  dot_all(model, workspace, t, count, r.data(), against.data());
  for (int i = 0; i < count; ++i) against[i] += contacts.dot(i, r);
  for (int i = count - 1; i >= 0; --i) {
    double beta = against[i];
    for (int j = count - 1; j > i; --j) beta += factor[j] * product(j, i);
    factor[i] = alpha[i] - beta / product(i, i);
  }
  add_all(model, workspace, s, factor.data(), count, r.data());
  r = -r;
  timed.next(Phase::solve, "solve");
  const bool bent = initial.bend(model, inputs, workspace);
  timed.next(Phase::lbfgs, "L-BFGS");
  double slope = 0;
  Pointers gradient{workspace.current.gradient.data()};
  dot_all(model, workspace, gradient, 1, r.data(), &slope);
  if (bent && !(slope < 0)) {
    r = workspace.correction.unbent;
    dot_all(model, workspace, gradient, 1, r.data(), &slope);
  }
  return slope;
}

bool is_safely_positive(double st, double ss, double tt) { return st > 1e-10 * std::sqrt(ss * tt); }

void remember_pair(const Model& model, OpenWorkspace& workspace, PairHistory& history) {
  if (history.window == 0) return;
  if (workspace.is_bowed) {  // the arc has turned the body away from where the pairs were found
    history.clear();
    return;
  }
  const int next = (history.newest + 1) % history.window;
  Positions& s = workspace.step_pairs[next];
  Positions& t = workspace.gradient_pairs[next];
  const Iterate &from = workspace.current, &to = workspace.trial;
  s = to.x.topRows(model.free) - from.x.topRows(model.free);
  t = to.gradient - from.gradient;
  if (!from.contacts.empty()) {
    // Both gradients are taken with the planes that the search used. Friction is taken out, too: its stiffness falls
    // while it slides, and a pair that tells so lets the next direction slide past where it would stick.
    add_contacts(from.contacts, to.x, nullptr, workspace.direction, &t, -1);
    add_contacts(from.contacts, from.x, nullptr, workspace.direction, &t, 1);
  }

  Pointers other{s.data(), t.data()};
  double of_t[2];  // s.t and t.t
  dot_all(model, workspace, other, 2, t.data(), of_t);
  double of_s = 0;
  dot_all(model, workspace, other, 1, s.data(), &of_s);
  if (!is_safely_positive(of_t[0], of_s, of_t[1])) {
    // The slot that was overwritten held the oldest pair of a full window.
    if (history.count == history.window) --history.count;
    return;
  }
  history.newest = next;
  history.count = std::min(history.count + 1, history.window);

  Pointers all{};
  Numbers with{};
  for (int i = 0; i < history.count; ++i) all[i] = workspace.step_pairs[history.place(i)].data();
  dot_all(model, workspace, all, history.count, t.data(), with.data());
  for (int i = 0; i < history.count; ++i) workspace.products[history.place(i) * history.window + next] = with[i];
  for (int i = 0; i < history.count; ++i) all[i] = workspace.gradient_pairs[history.place(i)].data();
  dot_all(model, workspace, all, history.count, s.data(), with.data());
  for (int i = 0; i < history.count; ++i) workspace.products[next * history.window + history.place(i)] = with[i];
}

void SystemInverse::begin(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  // A step that starts again from where the body was is violent, and the stiffness at rest says little about it.
  const bool starts_again = !w.report.records.empty();
  const bool wanted = inputs.solver.levels > 1 && !starts_again && w.system == static_cast<const System*>(&model) &&
                      !w.turned_hessian_serves;
  const TimedPhase timed(w.clock, Phase::matrix, "second level");
  has_second_level_ = w.second_level_serves = wanted && w.second_level.begin(model, w.current.x);
  iterations_ = w.report.iterations;
}

void SystemInverse::apply(const Model& model, const StepInputs& inputs, OpenWorkspace& w, Positions& r, Positions& z) {
  if (w.turned_hessian_serves && w.current.contacts.empty()) return w.turned_hessian.solve(model, r, z);
  if (has_second_level_ && iterations_ != w.report.iterations) w.second_level.move_to(w.current.x);
  iterations_ = w.report.iterations;
  choose_sticking_system(model, inputs.solver.contact, w.current.x, w.correction);
  if (w.correction.stuck.serves()) has_second_level_ = false;
  w.second_level_serves = has_second_level_;
  w.correction.second = has_second_level_ ? &w.second_level : nullptr;
  const auto solve = [&](Positions& right, Positions& solution) {
    apply_inverse(model, inputs.solver.contact, w.correction, w.solve_scratch, right, solution);
  };
  if (w.air.fixed_amounts() == 0) return solve(r, z);
  // A solve may take directions out of `wanted`, and the last solve is to find all of them there.
  const std::vector<StiffDirection> wanted = w.correction.wanted;
  w.gas.begin(model, w.air, w.current.x, [&](Positions& right, Positions& solution) {
    w.correction.wanted = wanted;
    solve(right, solution);
  });
  w.correction.wanted = wanted;
  solve(r, z);
  w.gas.correct(z);
}

bool SystemInverse::bend(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  return foresee_contacts(model, inputs.solver.contact, w.current.contacts, w.current.x, w.correction, w.direction);
}

}  // namespace supple
