#include "sim/linear/place_order.h"

#include <algorithm>
#include <span>

namespace supple {
namespace {

constexpr std::size_t smallest_cut = 24;  // fewer unknowns stay in the order in which they are

class Dissection {
 public:
  Dissection(const Eigen::SparseMatrix<double>& pattern, const Positions& places) : places_(places) {
    const auto count = static_cast<std::int32_t>(pattern.cols());
    const auto each_edge = [&](const auto& visit) {
      for (std::int32_t column = 0; column < count; ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator entry(pattern, column); entry; ++entry) {
          if (entry.row() == column) continue;
          visit(column, static_cast<std::int32_t>(entry.row()));
          visit(static_cast<std::int32_t>(entry.row()), column);
        }
      }
    };
    begin_.assign(count + 1, 0);
    each_edge([&](std::int32_t from, std::int32_t) { ++begin_[from + 1]; });
    for (std::int32_t v = 0; v < count; ++v) begin_[v + 1] += begin_[v];
    neighbour_.resize(begin_[count]);
    std::vector<std::int32_t> next(begin_.begin(), begin_.end() - 1);
    each_edge([&](std::int32_t from, std::int32_t to) { neighbour_[next[from]++] = to; });
    side_.assign(count, 0);
    order_.resize(count);
    for (std::int32_t v = 0; v < count; ++v) order_[v] = v;
  }

  std::vector<std::int32_t> run() {
    cut(order_);
    return std::move(order_);
  }

 private:
  // Sorts some unknowns: those before a plane, those behind it, and last those of one side that have a neighbour on the
  // other one. Of the planes across the three axes, that with the fewest of these serves.
  void cut(std::span<std::int32_t> all) {
    if (all.size() <= smallest_cut) {
      std::sort(all.begin(), all.end());
      return;
    }
    int best = 0;
    Border least = halve(all, 0);
    for (int axis = 1; axis < 3; ++axis) {
      if (const Border border = halve(all, axis); border.size < least.size) {
        least = border;
        best = axis;
      }
    }
    least = halve(all, best);
    const std::size_t half = all.size() / 2;
    const std::span<std::int32_t> own = least.is_before ? all.first(half) : all.subspan(half);
    const auto inner = std::partition(own.begin(), own.end(), [&](std::int32_t v) { return !touches(v, least.other); });
    const auto inside = static_cast<std::size_t>(inner - own.begin());
    if (!least.is_before) {
      cut(all.first(half));
      cut(own.first(inside));
      return;
    }
    std::rotate(inner, own.end(), all.end());  // the border goes behind the second half
    cut(own.first(inside));
    cut(all.subspan(inside, all.size() - half));
  }

  // Describes the unknowns of one half that have a neighbour in the other one.
  struct Border {
    bool is_before;      // of the plane
    std::int32_t other;  // the mark of the other half
    std::ptrdiff_t size;
  };

  // Puts the half of the unknowns that lie before a plane across an axis in front of the others. Returns the smaller of
  // the two borders.
  Border halve(std::span<std::int32_t> all, int axis) {
    const std::size_t half = all.size() / 2;
    std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(half), all.end(), [&](std::int32_t a, std::int32_t b) {
      const double at = places_(a, axis), bt = places_(b, axis);
      return at != bt ? at < bt : a < b;
    });
    const std::int32_t before = ++sides_, behind = ++sides_;
    for (std::size_t i = 0; i < all.size(); ++i) side_[all[i]] = i < half ? before : behind;
    const auto size_of = [&](std::span<std::int32_t> own, std::int32_t other) {
      return std::count_if(own.begin(), own.end(), [&](std::int32_t v) { return touches(v, other); });
    };
    const std::ptrdiff_t first = size_of(all.first(half), behind), second = size_of(all.subspan(half), before);
    return first < second ? Border{true, behind, first} : Border{false, before, second};
  }

  // Tells whether an unknown has a neighbour in a half.
  bool touches(std::int32_t v, std::int32_t side) const {
    return std::any_of(neighbour_.begin() + begin_[v], neighbour_.begin() + begin_[v + 1],
                       [&](std::int32_t to) { return side_[to] == side; });
  }

  const Positions& places_;
  std::vector<std::int32_t> begin_, neighbour_;  // by unknown
  std::vector<std::int32_t> side_;               // by unknown: the last half to which it belonged
  std::int32_t sides_ = 0;                       // how many halves there were
  std::vector<std::int32_t> order_;
};

}  // namespace

std::vector<std::int32_t> place_order(const Eigen::SparseMatrix<double>& pattern, const Positions& places) {
  return Dissection(pattern, places).run();
}

}  // namespace supple
