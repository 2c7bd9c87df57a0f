#include "sim/contact/capacitance.h"

#include <algorithm>
#include <cmath>

namespace supple {
namespace {

constexpr std::size_t most_axes = 8;  // axes of a list; beyond, all directions count as coupled with it
constexpr double right_angle = 1e-7;  // cosine below which directions are uncoupled in single precision

// Tells whether two stencils are the same; most of them are single vertices.
bool same(const ContactStencil& a, const ContactStencil& b) {
  return a.is_vertex() && b.is_vertex() ? a.vertex[0] == b.vertex[0] : a == b;
}

// Tells whether two stencils are equal or, between surfaces, nearly so: a point that slides on a triangle has other
// weights in each iterate. Weights that are wrong by 0.02 leave four times m/h^2 of a stiffness of 1e4 m/h^2 unknown.
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

std::uint64_t pose_of(const AddedMotions* motions) { return motions != nullptr ? motions->pose : 0; }

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

// Puts a direction into the list of those that are factored with it, and returns the number of that list. With added
// motions, several parts have one list, because motions couple directions at right angles, too; for a body alone the
// motions are added apart.
std::size_t Capacitance::home_of(const StiffDirection& direction, Eigen::Index number) {
  if (motions_ == nullptr || !has_several_parts()) return couple(direction, number, lists_);
  if (lists_.empty()) lists_.emplace_back();
  lists_[0].members.push_back(number);
  return 0;
}

void Capacitance::clear() {
  directions_.clear();
  keys_.clear();
  lists_.clear();
  begin_.clear();
  motions_of_ = 0;
  is_changed_ = true;
}

void Capacitance::begin_step(const System& system, const std::vector<Part>& parts) {
  clear();
  parts_.set(parts);
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
  if (entries_of_ != system.id || (has_several_parts() && motions_of_ != pose_of(motions_))) before.clear();
  begin_.clear();
  std::vector<bool> taken(wanted.size(), false);
  std::vector<Eigen::Index> place;  // where the earlier directions are now; -1: gone
  for (const StiffDirection& direction : before) {
    const bool stays = take_alike(wanted, direction, taken);
    place.push_back(stays ? static_cast<Eigen::Index>(ordered.size()) : -1);
    if (stays) ordered.push_back(direction);
  }
  is_changed_ |= place.size() != wanted.size() || std::find(place.begin(), place.end(), -1) != place.end();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!taken[i]) ordered.push_back(wanted[i]);
  }
  for (std::size_t i = 0; i < ordered.size(); ++i) home_of(ordered[i], static_cast<Eigen::Index>(i));
  directions_.swap(ordered);
  keys_.clear();
  for (const StiffDirection& direction : directions_) keys_.push_back(parts_.of(direction.stencil));
  keep_rows(place);
  factors_.resize(std::max(factors_.size(), lists_.size()));
  for (std::size_t i = 0; i < lists_.size(); ++i) {
    if (!place.empty() && i < lists_before.size()) {
      factors_[i].replace(lists_[i].members, keys_, place);
    } else {
      factors_[i].begin(lists_[i].members, keys_);
    }
  }
  return append(system, {}, threads);
}

// A list that has grown at its end keeps its factor; where lists were merged, all are factored again.
bool Capacitance::append(const System& system, const std::vector<StiffDirection>& more, Threads* threads) {
  is_changed_ |= !more.empty();
  bool is_merged = false;
  for (const StiffDirection& direction : more) {
    const std::size_t count = lists_.size();
    const auto number = static_cast<Eigen::Index>(directions_.size());
    const std::size_t home = home_of(direction, number);
    directions_.push_back(direction);
    keys_.push_back(parts_.of(direction.stencil));
    factors_.resize(std::max(factors_.size(), lists_.size()));
    is_merged |= lists_.size() < count;
    if (is_merged) continue;
    if (lists_.size() > count) {
      factors_[home].begin({number}, keys_);
    } else {
      factors_[home].append(number, keys_.back());
    }
  }
  if (is_merged) {
    for (std::size_t i = 0; i < lists_.size(); ++i) factors_[i].begin(lists_[i].members, keys_);
  }
  std::vector<std::int32_t> touched;
  for (const StiffDirection& direction : directions_) {
    const auto first = direction.stencil.vertex.begin();
    touched.insert(touched.end(), first, first + direction.stencil.free);
  }
  know_motions();
  if (entries_of_ != system.id) entries_.clear();
  entries_of_ = system.id;
  entries_.learn(system.factor, touched, threads);
  if (!extend(threads)) {
    clear();
    return false;
  }
  couple_motions();
  return true;
}

// Threads share lists where there are several, and else the blocks of the only one.
bool Capacitance::extend(Threads* threads) {
  long work = 0;
  for (std::size_t i = 0; i < lists_.size(); ++i) work += factors_[i].work();
  std::vector<char> done(lists_.size());
  Threads* const inside = lists_.size() == 1 ? threads : nullptr;
  const BlockFactor::Fill fill_block = [this](auto rows, auto columns, Eigen::Index shift,
                                              Eigen::Ref<RowMatrix> block) { fill(rows, columns, shift, block); };
  run_chunks(inside != nullptr ? nullptr : threads, static_cast<int>(lists_.size()), work,
             [&](int i) { done[i] = factors_[i].compute(fill_block, inside); });
  return std::find(done.begin(), done.end(), 0) == done.end();
}

Capacitance::Point Capacitance::point_of(const ContactStencil& stencil) const {
  Point point{.stencil = &stencil};
  for (int k = 0; k < stencil.free; ++k) point.place[k] = entries_.place(stencil.vertex[k]);
  return point;
}

// Returns the entry of A^-1 between two points: the sum of the entries among their vertices, by both points' weights.
float Capacitance::entry(const Point& a, const Point& b) const {
  if (a.stencil->is_vertex() && b.stencil->is_vertex()) return entries_.entry(a.place[0], b.place[0]);
  double sum = 0;
  for (int i = 0; i < a.stencil->free; ++i) {
    for (int j = 0; j < b.stencil->free; ++j)
      sum += a.stencil->weight[i] * b.stencil->weight[j] * entries_.entry(a.place[i], b.place[j]);
  }
  return static_cast<float>(sum);
}

// Consecutive directions of one point share the entries between points.
void Capacitance::fill(std::span<const Eigen::Index> rows, std::span<const Eigen::Index> columns, Eigen::Index shift,
                       Eigen::Ref<RowMatrix> block) const {
  const auto count = std::ssize(columns);
  std::vector<Vec3> axes;
  std::vector<Point> points;  // of the columns; neighbours of the same point share one
  std::vector<std::size_t> point_of_column;
  std::vector<float> between(columns.size());  // entries between the row's point and those of the first columns
  for (const Eigen::Index column : columns) {
    const StiffDirection& direction = directions_[column];
    axes.push_back(direction.axis);
    if (points.empty() || !same(direction.stencil, *points.back().stencil))
      points.push_back(point_of(direction.stencil));
    point_of_column.push_back(points.size() - 1);
  }
  Point own;
  Eigen::Index known = 0;  // columns of `between`
  for (Eigen::Index i = 0; i < std::ssize(rows); ++i) {
    const StiffDirection& direction = directions_[rows[i]];
    const Eigen::Index end = std::min(count, shift + i + 1);
    if (own.stencil == nullptr || !same(direction.stencil, *own.stencil)) {
      own = point_of(direction.stencil);
      known = 0;
    }
    for (; known < end; ++known) {
      const std::size_t point = point_of_column[known];
      const bool is_next = known == 0 || point != point_of_column[known - 1];
      between[known] = is_next ? entry(own, points[point]) : between[known - 1];
    }
    float* const values = &block(i, 0);
    const Vec3 axis = direction.axis;
    for (Eigen::Index j = 0; j < end; ++j) values[j] = static_cast<float>(axis.dot(axes[j])) * between[j];
    if (shift + i < count) values[shift + i] += static_cast<float>(1 / direction.stiffness);
  }
  if (motions_ != nullptr && has_several_parts()) add_products_of_motions(rows, columns, block);
}

}  // namespace supple
