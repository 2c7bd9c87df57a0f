#include "sim/contact_direction.h"

#include <algorithm>
#include <cmath>

#include "sim/objective.h"

namespace supple {
namespace {

constexpr std::size_t most_low_rank = 600;  // stiff directions; a dense factorisation of more costs more than it gains

// A body that nothing holds moves as a whole by exactly 1^T M z = h^2/w 1^T r, because L does not see translations;
// single precision only nearly does so, and would let the centre of mass drift.
void restore_translation(const Model& model, const Positions& r, Positions& z) {
  Eigen::RowVector3d wanted = Eigen::RowVector3d::Zero(), found = Eigen::RowVector3d::Zero();
  for (int v = 0; v < model.free; ++v) {
    wanted += r.row(v);
    found += model.mass[v] * z.row(v);
  }
  const double h = model.time_step;
  const Eigen::RowVector3d shift = (h * h / model.scheme.inertia * wanted - found) / model.total_mass;
  for (int v = 0; v < model.free; ++v) z.row(v) += shift;
}

void solve(const Model& model, Workspace& w, const Positions& r, Positions& z) {
  model.factor.solve(r.data(), z.data(), w.solve_scratch.data());
  if (model.free_floating) restore_translation(model, r, z);
}

void collect(const Model& model, const Workspace& w, std::vector<StiffDirection>& stiff) {
  stiff.clear();
  for (const Contact& contact : w.contact.found) {
    if (contact.depth <= 0) continue;
    stiff.push_back({contact.vertex, contact.normal, 2 * contact.stiffness});
    if (contact.friction <= 0) continue;
    const double along = friction_stiffness(contact, w.x, w.contact.stick_length);
    if (along < model.diagonal[contact.vertex]) continue;  // A outweighs it
    const Vec3 n = contact.normal;
    const Vec3 side = n.cross(std::abs(n.y()) < 0.7 ? Vec3::UnitY() : Vec3::UnitX()).normalized();
    stiff.push_back({contact.vertex, side, along});
    stiff.push_back({contact.vertex, n.cross(side), along});
  }
}

// A vertex with several stiff directions that are not at right angles goes through its projections in turn, and back in
// the opposite order.
void apply_diagonal(const Model& model, Workspace& w, Positions& r, Positions& z) {
  ContactCorrection& c = w.correction;
  c.answer.resize(static_cast<Eigen::Index>(c.stiff.size()));
  for (std::size_t i = 0; i < c.stiff.size(); ++i) {
    const StiffDirection& s = c.stiff[i];
    const double part = r.row(s.vertex).dot(s.axis);
    r.row(s.vertex) -= part * s.axis.transpose();
    c.answer[static_cast<Eigen::Index>(i)] = static_cast<float>(part / (model.diagonal[s.vertex] + s.stiffness));
  }
  solve(model, w, r, z);
  for (std::size_t i = c.stiff.size(); i-- > 0;) {
    const StiffDirection& s = c.stiff[i];
    z.row(s.vertex) += (c.answer[static_cast<Eigen::Index>(i)] - z.row(s.vertex).dot(s.axis)) * s.axis.transpose();
  }
}

// Makes sure that A^-1 is known between all vertices of the list. Three columns a solve; r and z are scratch.
void learn_columns(const Model& model, Workspace& w, Positions& r, Positions& z) {
  ContactCorrection& c = w.correction;
  if (c.column_of.size() != std::size_t(model.free)) {
    c.column_of.assign(model.free, -1);
    c.touched.clear();
    c.inverse.clear();
  }
  const std::size_t first = c.touched.size();
  for (const StiffDirection& s : c.stiff) {
    if (c.column_of[s.vertex] >= 0) continue;
    c.column_of[s.vertex] = static_cast<std::int32_t>(c.touched.size());
    c.touched.push_back(s.vertex);
  }
  for (std::size_t at = first; at < c.touched.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, c.touched.size() - at);
    r.setZero();
    for (std::size_t k = 0; k < count; ++k) r(c.touched[at + k], static_cast<Eigen::Index>(k)) = 1;
    model.factor.solve(r.data(), z.data(), w.solve_scratch.data());
    for (std::size_t k = 0; k < count; ++k) {
      std::vector<float> row(at + k + 1);
      for (std::size_t j = 0; j <= at + k; ++j)
        row[j] = static_cast<float>(z(c.touched[j], static_cast<Eigen::Index>(k)));
      c.inverse.push_back(std::move(row));
    }
  }
}

// Whether the factor at hand was made for the same stiff directions, or nearly: the correction need not be exact.
bool still_good(const ContactCorrection& c) {
  if (c.stiff.size() != c.factored.size()) return false;
  for (std::size_t i = 0; i < c.stiff.size(); ++i) {
    const StiffDirection &a = c.stiff[i], &b = c.factored[i];
    if (a.vertex != b.vertex || a.axis.dot(b.axis) < 0.999 || std::abs(a.stiffness - b.stiffness) > 0.1 * a.stiffness)
      return false;
  }
  return true;
}

bool factor_capacitance(ContactCorrection& c) {
  const auto n = static_cast<Eigen::Index>(c.stiff.size());
  c.dense.resize(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const StiffDirection& b = c.stiff[j];
    const std::int32_t column = c.column_of[b.vertex];
    for (Eigen::Index i = j; i < n; ++i) {
      const StiffDirection& a = c.stiff[i];
      const std::int32_t row = c.column_of[a.vertex];
      c.dense(i, j) = static_cast<float>(a.axis.dot(b.axis)) * c.inverse[std::max(row, column)][std::min(row, column)];
    }
    c.dense(j, j) += static_cast<float>(1 / b.stiffness);
  }
  c.capacitance.compute(c.dense);
  c.factored = c.stiff;
  return c.capacitance.info() == Eigen::Success;
}

bool apply_low_rank(const Model& model, Workspace& w, const Positions& r, Positions& z) {
  ContactCorrection& c = w.correction;
  if (!still_good(c)) {
    Positions& scratch = w.correction_scratch;
    scratch.resize(model.free, 3);
    learn_columns(model, w, scratch, z);
    if (!factor_capacitance(c)) {
      c.factored.clear();
      return false;
    }
  }
  solve(model, w, r, z);
  const auto n = static_cast<Eigen::Index>(c.factored.size());
  c.answer.resize(n);
  for (Eigen::Index i = 0; i < n; ++i)
    c.answer[i] = static_cast<float>(z.row(c.factored[i].vertex).dot(c.factored[i].axis));
  c.capacitance.solveInPlace(c.answer);
  Positions& push = w.correction_scratch;
  push.setZero(model.free, 3);
  for (Eigen::Index i = 0; i < n; ++i) push.row(c.factored[i].vertex) += c.answer[i] * c.factored[i].axis.transpose();
  Positions& back = w.correction_back;
  back.resize(model.free, 3);
  solve(model, w, push, back);
  z -= back;
  return true;
}

}  // namespace

void apply_inverse(const Model& model, Workspace& w, const ContactSettings& settings, Positions& r, Positions& z) {
  ContactCorrection& c = w.correction;
  if (w.contact.found.empty() || settings.direction == ContactDirection::ignored) return solve(model, w, r, z);
  collect(model, w, c.stiff);
  if (c.stiff.empty()) return solve(model, w, r, z);
  const bool dense = settings.direction == ContactDirection::low_rank && c.stiff.size() <= most_low_rank;
  if (!dense || !apply_low_rank(model, w, r, z)) apply_diagonal(model, w, r, z);
}

}  // namespace supple
