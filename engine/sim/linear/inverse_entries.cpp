#include "sim/linear/inverse_entries.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/linear/parted_solve.h"

namespace supple {

void InverseEntries::prepare(const CholeskyFactor& factor) {
  if (!to_root_.empty()) return;
  const PanelsView view = factor.view();
  slot_of_.assign(factor.size(), -1);
  to_root_.resize(view.panels);
  for (int panel = view.panels - 1; panel >= 0; --panel) {
    const std::int32_t parent = factor.parent_of(panel);
    to_root_[panel] = view.width[panel] + (parent >= 0 ? to_root_[parent] : 0);
  }
}

void InverseEntries::learn(const CholeskyFactor& factor, const std::vector<std::int32_t>& unknowns) {
  prepare(factor);
  std::vector<std::int32_t> fresh;
  for (const std::int32_t unknown : unknowns) {
    if (slot_of_[unknown] < 0) fresh.push_back(unknown);
  }
  std::sort(fresh.begin(), fresh.end());
  fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
  for (std::size_t at = 0; at < fresh.size(); at += 4) {
    const int count = static_cast<int>(std::min<std::size_t>(4, fresh.size() - at));
    factor.precision() == Precision::single_precision ? learn_four<float>(factor, &fresh[at], count)
                                                      : learn_four<double>(factor, &fresh[at], count);
  }
  products_.resize(columns_.size() * (columns_.size() + 1) / 2, std::numeric_limits<float>::quiet_NaN());
}

template <class T>
void InverseEntries::learn_four(const CholeskyFactor& factor, const std::int32_t* unknowns, int count) {
  const PanelsView view = factor.view();
  room_.resize(4 * std::size_t(factor.size()));
  T* x = reinterpret_cast<T*>(room_.data());
  const FactorPart part = paths_to_root(factor, {unknowns, unknowns + count});
  for (const std::int32_t panel : part)
    std::fill_n(x + 4 * long(view.first_column[panel]), 4 * view.width[panel], T(0));
  for (int k = 0; k < count; ++k) x[4 * long(unknowns[k]) + k] = 1;
  const int panels = static_cast<int>(part.size());
  if constexpr (sizeof(T) == 4) {
    linear_kernels().down_float(view, part.data(), panels, x);
  } else {
    linear_kernels().down_double(view, part.data(), panels, x);
  }
  for (int k = 0; k < count; ++k) {
    slot_of_[unknowns[k]] = static_cast<std::int32_t>(columns_.size());
    AlignedVector<float>& column = columns_.emplace_back();
    column.reserve(to_root_[factor.panel_of(unknowns[k])]);
    for (std::int32_t panel = factor.panel_of(unknowns[k]); panel >= 0; panel = factor.parent_of(panel)) {
      const long first = view.first_column[panel];
      for (long i = first; i < first + view.width[panel]; ++i) column.push_back(static_cast<float>(x[4 * i + k]));
    }
    stored_ += static_cast<std::int64_t>(column.size());
  }
}

float InverseEntries::entry(const CholeskyFactor& factor, std::int32_t a, std::int32_t b) {
  const auto [low, high] = std::minmax(slot_of_[a], slot_of_[b]);
  float& known = products_[std::size_t(high) * (high + 1) / 2 + low];
  if (std::isnan(known)) known = product(factor, a, b);
  return known;
}

float InverseEntries::product(const CholeskyFactor& factor, std::int32_t a, std::int32_t b) const {
  std::int32_t p = factor.panel_of(a), q = factor.panel_of(b);
  while (p != q && p >= 0 && q >= 0) {
    if (p < q) {
      p = factor.parent_of(p);
    } else {
      q = factor.parent_of(q);
    }
  }
  if (p < 0 || q < 0) return 0;  // two parts of the body that do not hold together
  const long count = to_root_[p];
  const AlignedVector<float>&u = columns_[slot_of_[a]], &v = columns_[slot_of_[b]];
  return linear_kernels().dot_float(u.data() + u.size() - count, v.data() + v.size() - count, count);
}

}  // namespace supple
