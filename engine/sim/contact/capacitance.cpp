#include "sim/contact/capacitance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace supple {
namespace {

constexpr std::size_t most_axes = 8;  // axes of a list; beyond, all directions count as coupled with it
constexpr double right_angle = 1e-7;  // cosine below which directions are uncoupled in single precision

// Compares points, of which most are vertices.
bool same(const ContactStencil& a, const ContactStencil& b) {
  return a.is_vertex() && b.is_vertex() ? a.vertex[0] == b.vertex[0] : a == b;
}

// Tells whether two stencils are equal or, between surfaces, nearly so: a point that slides on a triangle has other
// weights in each iterate. Wrong by 0.02, the weights of a stiffness of 1e4 m/h^2 leave four times m/h^2 unknown.
bool alike(const ContactStencil& a, const ContactStencil& b) {
  constexpr double much = 0.02;
  if (same(a, b)) return true;
  if (!a.is_between_surfaces() || a.count != b.count || a.vertex != b.vertex) return false;
  for (int k = 0; k < a.count; ++k) {
    if (std::abs(a.weight[k] - b.weight[k]) > much) return false;
  }
  return true;
}

// Tells whether two directions are equal, or so nearly that a correction may take one for the other.
bool alike(const StiffDirection& s, const StiffDirection& t) {
  return alike(s.stencil, t.stencil) && s.axis.dot(t.axis) >= 0.999 &&
         std::abs(s.stiffness - t.stiffness) <= 0.1 * s.stiffness;
}

// Takes the direction that is like `wanted` from `left`, which is sorted by first vertex, and marks it in `taken`.
// Returns whether there is one.
bool take_alike(const std::vector<StiffDirection>& left, const StiffDirection& wanted, std::vector<bool>& taken) {
  const std::int32_t first = wanted.stencil.vertex[0];
  auto at = std::lower_bound(left.begin(), left.end(), first,
                             [](const StiffDirection& s, std::int32_t vertex) { return s.stencil.vertex[0] < vertex; });
  for (; at != left.end() && at->stencil.vertex[0] == first; ++at) {
    const auto number = static_cast<std::size_t>(at - left.begin());
    if (taken[number] || !alike(wanted, *at)) continue;
    return taken[number] = true;
  }
  return false;
}

bool coupled(const CoupledDirections& list, const Vec3& axis) {
  return list.axes.size() > most_axes || std::any_of(list.axes.begin(), list.axes.end(), [&](const Vec3& known) {
           return std::abs(known.dot(axis)) > right_angle;
         });
}

void add_axis(CoupledDirections& list, const Vec3& axis) {
  if (list.axes.size() > most_axes || std::find(list.axes.begin(), list.axes.end(), axis) != list.axes.end()) return;
  list.axes.push_back(axis);
}

}  // namespace

std::size_t couple(const StiffDirection& direction, Eigen::Index number, std::vector<CoupledDirections>& lists) {
  std::size_t home = lists.size();
  for (std::size_t i = 0; i < lists.size();) {
    if (!coupled(lists[i], direction.axis)) {
      ++i;
    } else if (home == lists.size()) {
      home = i++;
    } else {
      lists[home].members.insert(lists[home].members.end(), lists[i].members.begin(), lists[i].members.end());
      for (const Vec3& axis : lists[i].axes) add_axis(lists[home], axis);
      lists.erase(lists.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  if (home == lists.size()) lists.emplace_back();
  add_axis(lists[home], direction.axis);
  lists[home].members.push_back(number);
  return home;
}

void Capacitance::clear() {
  directions_.clear();
  lists_.clear();
  rows_of_ = 0;
}

void Capacitance::begin_step(const System& system) {
  clear();
  if (entries_.stored_numbers() > system.factor.stored_numbers()) entries_.clear();
}

// Directions that the system has already stay where they are, and new ones are added at the end: all directions before
// the first one that has gone keep their factor. The contacts for which the last direction was bent give such new
// directions.
bool Capacitance::set(const System& system, const std::vector<StiffDirection>& wanted, Threads* threads) {
  std::vector<StiffDirection> before, ordered;
  std::vector<CoupledDirections> lists_before;
  before.swap(directions_);
  lists_before.swap(lists_);
  if (entries_of_ != system.id) before.clear();
  std::vector<bool> taken(wanted.size(), false);
  std::vector<Eigen::Index> place;  // where the earlier directions are now; -1: gone
  for (const StiffDirection& direction : before) {
    const bool stays = take_alike(wanted, direction, taken);
    place.push_back(stays ? static_cast<Eigen::Index>(ordered.size()) : -1);
    if (stays) ordered.push_back(direction);
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!taken[i]) ordered.push_back(wanted[i]);
  }
  for (std::size_t i = 0; i < ordered.size(); ++i) couple(ordered[i], static_cast<Eigen::Index>(i), lists_);
  directions_.swap(ordered);
  keep_rows(place);
  factors_.resize(std::max(factors_.size(), lists_.size()));
  for (std::size_t i = 0; i < lists_.size(); ++i) {
    Eigen::Index kept = 0;
    if (!place.empty() && i < lists_before.size()) {
      const std::vector<Eigen::Index>&was = lists_before[i].members, &is = lists_[i].members;
      const std::size_t most = std::min(was.size(), is.size());
      while (std::size_t(kept) < most && place[was[kept]] == is[kept]) ++kept;
    }
    factors_[i].keep(kept);
  }
  return append(system, {}, threads);
}

// A list that has grown at its end keeps its factor; where lists were merged, all are factored again.
bool Capacitance::append(const System& system, const std::vector<StiffDirection>& more, Threads* threads) {
  for (const StiffDirection& direction : more) {
    const std::size_t count = lists_.size();
    const std::size_t home = couple(direction, static_cast<Eigen::Index>(directions_.size()), lists_);
    directions_.push_back(direction);
    factors_.resize(std::max(factors_.size(), lists_.size()));
    if (lists_.size() > count) factors_[home].keep(0);
    if (lists_.size() < count) {
      for (Factor& factor : factors_) factor.keep(0);
    }
  }
  std::vector<std::int32_t> touched;
  for (const StiffDirection& direction : directions_) {
    const auto first = direction.stencil.vertex.begin();
    touched.insert(touched.end(), first, first + direction.stencil.free);
  }
  if (entries_of_ != system.id) entries_.clear();
  entries_of_ = system.id;
  entries_.learn(system.factor, touched, threads);
  long work = 0;
  for (std::size_t i = 0; i < lists_.size(); ++i) {
    const auto size = static_cast<long>(lists_[i].members.size());
    work += size * size * (size - factors_[i].factored) / 16;
  }
  std::vector<char> done(lists_.size());
  run_chunks(threads, static_cast<int>(lists_.size()), work, [&](int i) { done[i] = extend(lists_[i], factors_[i]); });
  if (std::find(done.begin(), done.end(), 0) == done.end()) return true;
  clear();
  return false;
}

// Returns the entry of A^-1 between two points: the mean of the entries among their vertices, by both points' weights.
float Capacitance::entry(const ContactStencil& a, const ContactStencil& b) const {
  if (a.is_vertex() && b.is_vertex()) return entries_.entry(a.vertex[0], b.vertex[0]);
  double sum = 0;
  for (int i = 0; i < a.free; ++i) {
    for (int j = 0; j < b.free; ++j) sum += a.weight[i] * b.weight[j] * entries_.entry(a.vertex[i], b.vertex[j]);
  }
  return static_cast<float>(sum);
}

// Consecutive directions of one point share an entry.
void Capacitance::fill_row(const CoupledDirections& list, Eigen::Index row, float* values) const {
  const StiffDirection& own = directions_[list.members[row]];
  const ContactStencil* other = nullptr;
  float between = 0;
  for (Eigen::Index j = 0; j <= row; ++j) {
    const StiffDirection& s = directions_[list.members[j]];
    if (other == nullptr || !same(s.stencil, *other)) between = entry(own.stencil, s.stencil);
    other = &s.stencil;
    values[j] = static_cast<float>(own.axis.dot(s.axis)) * between;
  }
  values[row] += static_cast<float>(1 / own.stiffness);
}

void Capacitance::Factor::keep(Eigen::Index members) {
  factored = std::min(factored, members);
  seen_members = std::min(seen_members, members);
  if (summed > members) summed = 0;
}

bool Capacitance::extend(const CoupledDirections& list, Factor& factor) {
  const auto n = static_cast<Eigen::Index>(list.members.size()), first = factor.factored, more = n - first;
  if (more == 0) return true;
  RowMatrix& lower = factor.lower;
  if (lower.rows() < n) {
    RowMatrix larger = RowMatrix::Zero(n + n / 2, n + n / 2);
    larger.topLeftCorner(first, first) = lower.topLeftCorner(first, first);
    lower.swap(larger);
  }
  for (Eigen::Index i = first; i < n; ++i) fill_row(list, i, lower.row(i).data());
  auto below = lower.block(first, 0, more, first);
  auto corner = lower.block(first, first, more, more);
  if (first > 0) {
    auto right = below.transpose();
    lower.topLeftCorner(first, first).triangularView<Eigen::Lower>().solveInPlace(right);
    corner.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
  }
  const Eigen::LLT<Eigen::Ref<RowMatrix>> done(corner);
  factor.factored = n;
  return done.info() == Eigen::Success;
}

void Capacitance::solve(Eigen::VectorXf& answer) const {
  Eigen::VectorXf part;
  for (std::size_t i = 0; i < lists_.size(); ++i) {
    const std::vector<Eigen::Index>& members = lists_[i].members;
    const auto n = static_cast<Eigen::Index>(members.size());
    part = answer(members);
    const auto lower = factors_[i].lower.topLeftCorner(n, n).triangularView<Eigen::Lower>();
    lower.solveInPlace(part);
    lower.transpose().solveInPlace(part);
    answer(members) = part;
  }
}

// Moves the rows of directions that stay to where these are now.
void Capacitance::keep_rows(const std::vector<Eigen::Index>& place) {
  if (rows_of_ == 0) return;
  RowMatrix rows(std::ssize(directions_), rows_.cols());
  std::vector<char> known(directions_.size(), 0);
  for (std::size_t i = 0; i < std::min(place.size(), known_.size()); ++i) {
    if (place[i] < 0 || known_[i] == 0) continue;
    rows.row(place[i]) = rows_.row(static_cast<Eigen::Index>(i));
    known[place[i]] = 1;
  }
  rows_.swap(rows);
  known_.swap(known);
}

bool Capacitance::know_rows(std::uint64_t pose, int r, const FindRow& find_row) {
  if (rows_of_ != pose) {
    rows_of_ = pose;
    known_.clear();
    lists_counted_ = 0;
    for (Factor& factor : factors_) factor.seen_members = factor.summed = 0;
  }
  const std::size_t before = known_.size(), count = directions_.size();
  if (before < count || rows_.cols() != r) rows_.conservativeResize(static_cast<Eigen::Index>(count), r);
  known_.resize(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (known_[i] == 0) find_row(directions_[i], rows_.row(static_cast<Eigen::Index>(i)).data());
    known_[i] = 1;
  }
  bool is_new = lists_counted_ != lists_.size();
  for (std::size_t i = 0; i < lists_.size(); ++i) is_new |= count_rows(lists_[i], factors_[i]);
  if (!is_new) return false;
  lists_counted_ = lists_.size();
  between_.setZero(r, r);
  for (std::size_t i = 0; i < lists_.size(); ++i)
    between_.triangularView<Eigen::Lower>() += factors_[i].product.cast<double>();
  between_.triangularView<Eigen::StrictlyUpper>() = between_.transpose();
  return true;
}

bool Capacitance::count_rows(const CoupledDirections& list, Factor& factor) const {
  const auto n = static_cast<Eigen::Index>(list.members.size()), r = rows_.cols();
  if (factor.summed == n) return false;
  const Eigen::Index first = factor.seen_members, more = n - first;
  if (factor.seen.rows() < n || factor.seen.cols() != r) factor.seen.conservativeResize(n + n / 2, r);
  if (more > 0) {
    auto added = factor.seen.middleRows(first, more);
    for (Eigen::Index i = 0; i < more; ++i) added.row(i) = rows_.row(list.members[first + i]);
    if (first > 0) added.noalias() -= factor.lower.block(first, 0, more, first) * factor.seen.topRows(first);
    factor.lower.block(first, first, more, more).triangularView<Eigen::Lower>().solveInPlace(added);
    factor.seen_members = n;
  }
  if (factor.summed == 0) factor.product.setZero(r, r);
  factor.product.selfadjointView<Eigen::Lower>().rankUpdate(
      factor.seen.middleRows(factor.summed, n - factor.summed).transpose());
  factor.summed = n;
  return true;
}

}  // namespace supple
