#include "sim/linear/cholesky.h"

// This macro leaves out the declarations of CHOLMOD's modules under the GPL, so that nothing here can call them.
#define NGPL
#include <cholmod.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <type_traits>

#include "base/error.h"
#include "base/signals.h"
#include "sim/linear/multifrontal.h"

namespace supple {
namespace {

// Holds CHOLMOD's settings and workspace: it orders by METIS alone, and analyses only as much of the factor as that
// requires.
struct Cholmod {
  cholmod_common common;
  Cholmod() {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SIMPLICIAL;  // the supernodal analysis is under the GPL
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.print = 0;
    common.try_catch = 1;
  }
  ~Cholmod() { cholmod_finish(&common); }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  auto hold(cholmod_factor* factor) {
    const auto release = [this](cholmod_factor* f) { cholmod_free_factor(&f, &common); };
    return std::unique_ptr<cholmod_factor, decltype(release)>(factor, release);
  }
};

// Returns the pattern of an Eigen matrix's lower triangle without copying it.
cholmod_sparse pattern_of(Eigen::SparseMatrix<double>& matrix) {
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(matrix.rows());
  view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
  view.p = matrix.outerIndexPtr();
  view.i = matrix.innerIndexPtr();
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_PATTERN;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

}  // namespace

std::vector<std::int32_t> fill_reducing_order(int count,
                                              const std::vector<std::pair<std::int32_t, std::int32_t>>& edges) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(edges.size() + count);
  for (int i = 0; i < count; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [a, b] : edges) entries.emplace_back(std::max(a, b), std::min(a, b), 1.0);
  Eigen::SparseMatrix<double> pattern(count, count);
  pattern.setFromTriplets(entries.begin(), entries.end());
  if (count == 0) return {};

  Cholmod cholmod;
  cholmod_sparse view = pattern_of(pattern);
  static std::mutex one_at_a_time;  // METIS draws from the C library's random numbers, which all threads share
  const std::lock_guard lock(one_at_a_time);
  // METIS takes SIGTERM for an error of its own and gives up. CHOLMOD then continues with another order, which changes
  // the last bits of results, and the signal is lost.
  const BlockedSignals meanwhile;
  const auto factor = cholmod.hold(cholmod_analyze(&view, &cholmod.common));
  if (!factor || factor->ordering != CHOLMOD_METIS)
    throw RunError("the stiffness matrix could not be ordered: out of memory");
  const int* order = static_cast<const int*>(factor->Perm);
  return {order, order + count};
}

bool CholeskyFactor::has_pattern_of(const Eigen::SparseMatrix<double>& matrix) const {
  return matrix.rows() == size_ && !outer_.empty() &&
         std::equal(outer_.begin(), outer_.end(), matrix.outerIndexPtr()) &&
         std::equal(inner_.begin(), inner_.end(), matrix.innerIndexPtr());
}

void CholeskyFactor::analyze(const Eigen::SparseMatrix<double>& matrix) {
  *this = {};
  size_ = static_cast<int>(matrix.rows());
  outer_.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + size_ + 1);
  inner_.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
  elimination_ = Elimination::of(matrix);
  operations_ = elimination_.operations();
  rows_ = elimination_.rows;
  strip_of_.reserve(size_);
  for (const Supernode& node : elimination_.nodes) {
    const FrontShape shape = node.front();
    const auto first_strip = static_cast<std::int32_t>(front_of_.size());
    for (int i = 0; i < shape.pivots; ++i) strip_of_.push_back(first_strip + i / block_rows);
    front_of_.insert(front_of_.end(), strips_of(shape), static_cast<std::int32_t>(fronts_.size()));
    fronts_.push_back({shape, node.first, first_strip, node.first_row, number_count_});
    number_count_ += column_numbers(shape);
    most_rows_ = std::max(most_rows_, row_blocks_of(shape) * block_rows);
  }
}

std::int32_t CholeskyFactor::first_column(int strip) const {
  const FactorFront& front = fronts_[front_of_[strip]];
  return front.first + (strip - front.first_strip) * block_rows;
}

int CholeskyFactor::width(int strip) const {
  const FactorFront& front = fronts_[front_of_[strip]];
  return strip_width(front.shape, strip - front.first_strip);
}

std::int32_t CholeskyFactor::parent_of(int strip) const {
  const FactorFront& front = fronts_[front_of_[strip]];
  if (strip + 1 < front.first_strip + strips_of(front.shape)) return strip + 1;
  return front.shape.rows > 0 ? strip_of_[rows_[front.first_row]] : -1;
}

// The strips of a front follow each other on a path to the root; of two fronts on one path, the later one is closer to
// the root.
std::int32_t CholeskyFactor::meeting_of(std::int32_t a, std::int32_t b) const {
  while (a >= 0 && b >= 0 && front_of_[a] != front_of_[b]) {
    std::int32_t& earlier = a < b ? a : b;
    const FactorFront& front = fronts_[front_of_[earlier]];
    earlier = parent_of(front.first_strip + strips_of(front.shape) - 1);
  }
  return a >= 0 && b >= 0 ? std::max(a, b) : -1;
}

void CholeskyFactor::factorize(const Eigen::SparseMatrix<double>& matrix, Precision precision) {
  if (!has_pattern_of(matrix)) analyze(matrix);
  precision_ = precision;
  single_.resize(precision == Precision::single_precision ? number_count_ : 0);
  double_.resize(precision == Precision::double_precision ? number_count_ : 0);
  Room room;
  if (!renew(matrix, room))
    throw RunError(fmt::format("the stiffness matrix is not positive definite (unknown {})", room.failed_));
}

namespace {

// Appends numbers, each raised by an amount.
void append(std::vector<std::int32_t>& list, const std::vector<std::int32_t>& more, std::size_t raise) {
  for (const std::int32_t number : more) list.push_back(number + static_cast<std::int32_t>(raise));
}

}  // namespace

CholeskyFactor CholeskyFactor::block_diagonal(const std::vector<const CholeskyFactor*>& blocks) {
  CholeskyFactor all;
  if (!blocks.empty()) all.precision_ = blocks.front()->precision_;
  for (const CholeskyFactor* block : blocks) {
    SUPPLE_CHECK(int(block->precision_), ==, int(all.precision_));
    const std::size_t strips = all.front_of_.size();
    append(all.strip_of_, block->strip_of_, strips);
    append(all.front_of_, block->front_of_, all.fronts_.size());
    for (FactorFront front : block->fronts_) {
      front.first += all.size_;
      front.first_strip += static_cast<std::int32_t>(strips);
      front.first_row += std::ssize(all.rows_);
      front.first_number += all.number_count_;
      all.fronts_.push_back(front);
    }
    append(all.rows_, block->rows_, all.size_);
    all.single_.insert(all.single_.end(), block->single_.begin(), block->single_.end());
    all.double_.insert(all.double_.end(), block->double_.begin(), block->double_.end());
    all.number_count_ += block->number_count_;
    all.most_rows_ = std::max(all.most_rows_, block->most_rows_);
    all.operations_ += block->operations_;
    all.size_ += block->size_;
  }
  return all;
}

CholeskyFactor::Room::Room() = default;
CholeskyFactor::Room::~Room() = default;

bool CholeskyFactor::renew(const Eigen::SparseMatrix<double>& matrix, Room& room) {
  SUPPLE_CHECK(matrix.nonZeros(), ==, Eigen::Index(inner_.size()));
  if (!room.fronts_) room.fronts_ = std::make_unique<Multifrontal>(elimination_);
  if (precision_ == Precision::single_precision) room.columns_.resize(elimination_.most_column_numbers);
  room.fronts_->begin();
  for (const std::int32_t s : elimination_.order) {
    const bool narrow = precision_ == Precision::single_precision;
    double* columns = narrow ? room.columns_.data() : double_.data() + fronts_[s].first_number;
    room.failed_ = room.fronts_->eliminate(matrix, s, columns);
    if (room.failed_ >= 0) return false;
    invert_triangles(fronts_[s].shape, columns);
    if (narrow) std::copy_n(columns, column_numbers(fronts_[s].shape), single_.data() + fronts_[s].first_number);
  }
  return true;
}

FactorView CholeskyFactor::view() const {
  const void* numbers =
      precision_ == Precision::single_precision ? static_cast<const void*>(single_.data()) : double_.data();
  return {static_cast<int>(fronts_.size()),
          static_cast<int>(front_of_.size()),
          fronts_.data(),
          front_of_.data(),
          rows_.data(),
          numbers};
}

namespace {

// Solves with a half of the factor, in the precision of T. single, twice: the loops of both precisions.
template <class T>
void solve_half(LinearKernels::Solve<float> single, LinearKernels::Solve<double> twice, const FactorView& view,
                const std::vector<std::int32_t>* strips, T* x, T* scratch) {
  const std::int32_t* list = strips != nullptr ? strips->data() : nullptr;
  const int count = strips != nullptr ? static_cast<int>(strips->size()) : 0;
  if constexpr (std::is_same_v<T, float>) {
    single(view, list, count, x, scratch);
  } else {
    twice(view, list, count, x, scratch);
  }
}

}  // namespace

template <class T>
void CholeskyFactor::down(const std::vector<std::int32_t>* strips, T* x, T* scratch) const {
  solve_half(linear_kernels().down_float, linear_kernels().down_double, view(), strips, x, scratch);
}

template <class T>
void CholeskyFactor::up(const std::vector<std::int32_t>* strips, T* x, T* scratch) const {
  solve_half(linear_kernels().up_float, linear_kernels().up_double, view(), strips, x, scratch);
}

template void CholeskyFactor::down(const std::vector<std::int32_t>*, float*, float*) const;
template void CholeskyFactor::down(const std::vector<std::int32_t>*, double*, double*) const;
template void CholeskyFactor::up(const std::vector<std::int32_t>*, float*, float*) const;
template void CholeskyFactor::up(const std::vector<std::int32_t>*, double*, double*) const;

double solve_scale(const double* b, int count) {
  double largest = 0;
  for (int i = 0; i < count; ++i) largest = std::max(largest, std::abs(b[i]));
  return largest > 0 && std::isfinite(largest) ? std::exp2(-std::ilogb(largest)) : 1.0;
}

namespace {

template <class T>
void solve_interleaved(const CholeskyFactor& factor, const double* b, double* x, T* scratch, double scale) {
  const std::int64_t size = factor.size();
  const double back = 1 / scale;  // exact: the scale is a power of two
  T* const four = scratch + factor.front_numbers();
  for (std::int64_t i = 0; i < size; ++i) {
    for (int c = 0; c < 3; ++c) four[4 * i + c] = static_cast<T>(scale * b[3 * i + c]);
    four[4 * i + 3] = 0;
  }
  factor.down<T>(nullptr, four, scratch);
  factor.up<T>(nullptr, four, scratch);
  for (std::int64_t i = 0; i < size; ++i) {
    for (int c = 0; c < 3; ++c) x[3 * i + c] = back * static_cast<double>(four[4 * i + c]);
  }
}

}  // namespace

std::size_t CholeskyFactor::scratch_numbers() const {
  const std::size_t numbers = front_numbers() + 4 * std::size_t(size_);
  return precision_ == Precision::single_precision ? (numbers + 1) / 2 : numbers;
}

void CholeskyFactor::solve(const double* b, double* x, AlignedVector<double>& scratch) const {
  if (scratch.size() < scratch_numbers()) scratch.resize(scratch_numbers());
  if (precision_ == Precision::single_precision) {
    solve_interleaved(*this, b, x, reinterpret_cast<float*>(scratch.data()), solve_scale(b, 3 * size_));
  } else {
    solve_interleaved(*this, b, x, scratch.data(), 1.0);
  }
}

}  // namespace supple
