#include "sim/contact/contact_direction.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace supple {
namespace {

constexpr std::size_t most_remembered = std::size_t(1) << 26;  // numbers of A^-1 that are kept after a step: 256 MB
constexpr std::size_t most_low_rank = 600;  // stiff directions: a dense factorisation of more costs more than it gains

}  // namespace

void find_stiff_directions(const Model& model, const std::vector<Contact>& contacts, const Positions& x,
                           double stick_length, ContactCorrection& correction) {
  std::vector<StiffDirection>& stiff = correction.wanted;
  stiff.clear();
  for (const Contact& contact : contacts) {
    if (contact.depth > 0) stiff.push_back({contact.vertex, contact.normal, 2 * contact.stiffness});
  }
  correction.normals = stiff.size();
  for (const Contact& contact : contacts) {
    if (contact.friction <= 0) continue;  // it is lagged: a vertex may have left and still be rubbed
    const double along = friction_stiffness(contact, x, stick_length);
    // Even where the elements around it are stiffer, together they hold a body that would slide as a whole.
    if (along < model.scheme.inertia * model.mass[contact.vertex] / (model.time_step * model.time_step)) continue;
    const Vec3 n = contact.normal;
    const Vec3 side = n.cross(std::abs(n.y()) < 0.7 ? Vec3::UnitY() : Vec3::UnitX()).normalized();
    stiff.push_back({contact.vertex, side, along});
    stiff.push_back({contact.vertex, n.cross(side), along});
  }
}

namespace {

// A vertex with several stiff directions that are not at right angles goes through its projections in turn, and back in
// the opposite order.
void apply_diagonal(const Model& model, ContactCorrection& c, SolveScratch& scratch, Positions& r, Positions& z) {
  c.answer.resize(static_cast<Eigen::Index>(c.wanted.size()));
  for (std::size_t i = 0; i < c.wanted.size(); ++i) {
    const StiffDirection& s = c.wanted[i];
    const double part = r.row(s.vertex).dot(s.axis);
    r.row(s.vertex) -= part * s.axis.transpose();
    c.answer[static_cast<Eigen::Index>(i)] = static_cast<float>(part / (model.diagonal[s.vertex] + s.stiffness));
  }
  solve_system(model, r, z, scratch);
  for (std::size_t i = c.wanted.size(); i-- > 0;) {
    const StiffDirection& s = c.wanted[i];
    z.row(s.vertex) += (c.answer[static_cast<Eigen::Index>(i)] - z.row(s.vertex).dot(s.axis)) * s.axis.transpose();
  }
}

// Makes sure that the columns of A^-1 of all vertices of the list are known. A solve finds three of them; r and z are
// scratch.
void learn_columns(const Model& model, ContactCorrection& c, SolveScratch& scratch, Positions& r, Positions& z) {
  if (c.column_of.empty()) c.column_of.assign(model.free, -1);
  std::vector<std::int32_t> fresh;
  for (const StiffDirection& s : c.stiff) {
    if (c.column_of[s.vertex] >= 0) continue;
    c.column_of[s.vertex] = static_cast<std::int32_t>(c.inverse.size() + fresh.size());
    fresh.push_back(s.vertex);
  }
  for (std::size_t at = 0; at < fresh.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, fresh.size() - at);
    r.setZero();
    for (std::size_t k = 0; k < count; ++k) r(fresh[at + k], static_cast<Eigen::Index>(k)) = 1;
    model.factor.solve(r.data(), z.data(), scratch.data());
    for (std::size_t k = 0; k < count; ++k) c.inverse.emplace_back(z.col(static_cast<Eigen::Index>(k)).cast<float>());
  }
}

// Takes always the same one of the two entries that should be equal, whichever vertex was touched first.
float capacitance_entry(const ContactCorrection& c, const StiffDirection& a, const StiffDirection& b) {
  const auto [low, high] = std::minmax(a.vertex, b.vertex);
  return static_cast<float>(a.axis.dot(b.axis)) * c.inverse[c.column_of[high]][low];
}

// Appends the directions from `first` on to the Cholesky factor of the capacitance; c.stiff and c.lower agree up to
// there. Returns false when it is not positive definite.
bool extend_factor(ContactCorrection& c, Eigen::Index first) {
  const auto n = static_cast<Eigen::Index>(c.stiff.size()), more = n - first;
  if (c.lower.rows() < n) {
    Eigen::MatrixXf larger = Eigen::MatrixXf::Zero(n + n / 2, n + n / 2);
    larger.topLeftCorner(first, first) = c.lower.topLeftCorner(first, first);
    c.lower.swap(larger);
  }
  auto below = c.lower.block(first, 0, more, first);
  auto corner = c.lower.block(first, first, more, more);
  for (Eigen::Index i = 0; i < more; ++i) {
    for (Eigen::Index j = 0; j < first; ++j) below(i, j) = capacitance_entry(c, c.stiff[first + i], c.stiff[j]);
    for (Eigen::Index j = 0; j <= i; ++j) corner(i, j) = capacitance_entry(c, c.stiff[first + i], c.stiff[first + j]);
    corner(i, i) += static_cast<float>(1 / c.stiff[first + i].stiffness);
  }
  if (first > 0) {
    c.lower.topLeftCorner(first, first)
        .transpose()
        .triangularView<Eigen::Upper>()
        .solveInPlace<Eigen::OnTheRight>(below);
    corner.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
  }
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXf>> factor(corner);
  return factor.info() == Eigen::Success;
}

// Subtracts A^-1 N S^-1 e from z, with e given in c.answer.
void subtract_answer(const Model& model, ContactCorrection& c, SolveScratch& scratch, Positions& z) {
  const auto n = static_cast<Eigen::Index>(c.stiff.size());
  const auto lower = c.lower.topLeftCorner(n, n).triangularView<Eigen::Lower>();
  lower.solveInPlace(c.answer);
  lower.transpose().solveInPlace(c.answer);
  c.push.setZero(model.free, 3);
  c.back.resize(model.free, 3);
  for (Eigen::Index i = 0; i < n; ++i) c.push.row(c.stiff[i].vertex) += c.answer[i] * c.stiff[i].axis.transpose();
  solve_system(model, c.push, c.back, scratch);
  z -= c.back;
}

// Tells whether the factor was made for the same stiff directions, or nearly the same: the correction need not be
// exact.
bool still_good(const ContactCorrection& c, const std::vector<StiffDirection>& wanted) {
  if (c.stiff.size() != wanted.size()) return false;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const StiffDirection &a = c.stiff[i], &b = wanted[i];
    if (a.vertex != b.vertex || a.axis.dot(b.axis) < 0.999 || std::abs(a.stiffness - b.stiffness) > 0.1 * a.stiffness)
      return false;
  }
  return true;
}

// Chooses at most most_low_rank of the wanted directions: where there are more, every n-th stands for its neighbours, n
// times as stiff.
void thin_out(const std::vector<StiffDirection>& wanted, std::vector<StiffDirection>& chosen) {
  const std::size_t stride = (wanted.size() + most_low_rank - 1) / most_low_rank;
  chosen.clear();
  for (std::size_t i = 0; i < wanted.size(); i += stride) {
    chosen.push_back(wanted[i]);
    chosen.back().stiffness *= static_cast<double>(stride);
  }
}

bool apply_low_rank(const Model& model, ContactCorrection& c, SolveScratch& scratch, const Positions& r, Positions& z) {
  thin_out(c.wanted, c.chosen);
  if (!still_good(c, c.chosen)) {
    c.stiff = c.chosen;
    c.push.resize(model.free, 3);
    learn_columns(model, c, scratch, c.push, z);
    if (!extend_factor(c, 0)) {
      c.stiff.clear();
      return false;
    }
  }
  solve_system(model, r, z, scratch);
  c.answer.resize(static_cast<Eigen::Index>(c.stiff.size()));
  for (Eigen::Index i = 0; i < c.answer.size(); ++i)
    c.answer[i] = static_cast<float>(z.row(c.stiff[i].vertex).dot(c.stiff[i].axis));
  subtract_answer(model, c, scratch, z);
  return true;
}

}  // namespace

void forget_factor(const Model& model, ContactCorrection& c) {
  c.stiff.clear();
  if (c.inverse.size() * std::size_t(model.free) <= most_remembered) return;
  c.inverse.clear();
  c.column_of.clear();
}

bool foresee_contacts(const Model& model, const ContactSettings& settings, const std::vector<Contact>& contacts,
                      const Positions& x, ContactCorrection& c, SolveScratch& scratch, Positions& direction) {
  if (settings.direction != ContactDirection::low_rank || contacts.empty()) return false;
  if (c.wanted.size() > most_low_rank) return false;
  if (c.wanted.empty()) c.stiff.clear();
  c.entered.assign(c.stiff.size(), 0.0f);
  for (int pass = 0; pass < 3; ++pass) {
    const std::size_t first = c.stiff.size();
    for (const Contact& contact : contacts) {
      if (contact.depth > 0) continue;
      const double gap = contact.normal.dot(x.row(contact.vertex) + direction.row(contact.vertex)) - contact.offset;
      if (gap >= 0 || c.stiff.size() >= most_low_rank) continue;
      if (pass > 0 && std::find_if(c.stiff.begin(), c.stiff.end(), [&](const StiffDirection& s) {
                        return s.vertex == contact.vertex && s.axis == contact.normal;
                      }) != c.stiff.end())
        continue;
      c.stiff.push_back({contact.vertex, contact.normal, 2 * contact.stiffness});
      c.entered.push_back(static_cast<float>(gap));
    }
    if (c.stiff.size() == first) return pass > 0;
    if (pass == 0) c.unbent = direction;
    c.push.resize(model.free, 3);
    c.back.resize(model.free, 3);
    learn_columns(model, c, scratch, c.push, c.back);
    if (!extend_factor(c, static_cast<Eigen::Index>(first))) {
      c.stiff.clear();
      return pass > 0;
    }
    c.answer = Eigen::Map<const Eigen::VectorXf>(c.entered.data(), static_cast<Eigen::Index>(c.entered.size()));
    std::fill(c.entered.begin(), c.entered.end(), 0.0f);
    subtract_answer(model, c, scratch, direction);
  }
  return true;
}

void apply_inverse(const Model& model, const ContactSettings& settings, ContactCorrection& c, SolveScratch& scratch,
                   Positions& r, Positions& z) {
  if (c.wanted.empty() || settings.direction == ContactDirection::ignored) return solve_system(model, r, z, scratch);
  if (settings.direction == ContactDirection::diagonal) return apply_diagonal(model, c, scratch, r, z);
  if (!apply_low_rank(model, c, scratch, r, z)) solve_system(model, r, z, scratch);
}

}  // namespace supple
