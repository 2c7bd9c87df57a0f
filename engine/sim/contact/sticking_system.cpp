#include "sim/contact/sticking_system.h"

#include <algorithm>

#include "base/error.h"
#include "sim/linear/place_order.h"

namespace supple {
namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

void add(Entries& entries, std::int32_t a, std::int32_t b, double value) {
  entries.emplace_back(std::max(a, b), std::min(a, b), value);
}

}  // namespace

void StickingSystem::make(const System& system, const std::vector<Spring>& springs, const Positions& x) {
  const bool is_known = system_ == system.id && springs_ == springs && at_.rows() == x.rows() && at_ == x;
  if (!is_known) {
    system_ = system.id;
    at_ = x;
    springs_ = springs;
    joined_.clear();
    for (const Spring& spring : springs) joined_.push_back(spring.stencil.vertex);
    std::ranges::sort(joined_);
    is_factored_ = factorize(system);
  }
  serves_ = is_factored_;
}

bool StickingSystem::factorize(const System& system) {
  const Eigen::Index count = system.matrix.cols();
  Entries entries;
  entries.reserve(system.matrix.nonZeros() + 10 * springs_.size());
  for (Eigen::Index column = 0; column < count; ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(system.matrix, column); entry; ++entry)
      entries.emplace_back(entry.row(), column, entry.value());
  }
  for (const Spring& spring : springs_) {
    const ContactStencil& s = spring.stencil;
    for (int i = 0; i < s.free; ++i) {
      for (int j = 0; j <= i; ++j) add(entries, s.vertex[i], s.vertex[j], spring.stiffness * s.weight[i] * s.weight[j]);
    }
  }
  sum_.resize(count, count);
  sum_.setFromTriplets(entries.begin(), entries.end());
  order_ = place_order(sum_, at_);
  place_.resize(count);
  for (std::size_t i = 0; i < order_.size(); ++i) place_[order_[i]] = static_cast<std::int32_t>(i);
  entries.clear();
  diagonal_.resize(count);
  for (Eigen::Index column = 0; column < count; ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(sum_, column); entry; ++entry) {
      add(entries, place_[entry.row()], place_[column], entry.value());
      if (entry.row() == column) diagonal_[column] = entry.value();
    }
  }
  ordered_.resize(count, count);
  ordered_.setFromTriplets(entries.begin(), entries.end());
  try {
    factor_.factorize(ordered_, system.factor.precision());
    return true;
  } catch (const RunError&) {
    return false;
  }
}

bool StickingSystem::has(const ContactStencil& stencil) const {
  return std::ranges::binary_search(joined_, stencil.vertex);
}

void StickingSystem::solve(const Positions& r, Positions& z) {
  const auto count = static_cast<Eigen::Index>(order_.size());
  right_.resize(count, 3);
  solution_.resize(count, 3);
  z.resize(count, 3);
  for (Eigen::Index v = 0; v < count; ++v) right_.row(place_[v]) = r.row(v);
  factor_.solve(right_.data(), solution_.data(), scratch_);
  for (Eigen::Index v = 0; v < count; ++v) z.row(v) = solution_.row(place_[v]);
}

}  // namespace supple
