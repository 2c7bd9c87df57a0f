#include "sim/linear/cholesky.h"

// This macro leaves out the declarations of CHOLMOD's modules under the GPL, so that nothing here can call them.
#define NGPL
#include <cholmod.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

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

// Cuts supernodes into panels of equal width; the rows below a panel are the supernode's later columns and its rows.
void CholeskyFactor::analyze(const Eigen::SparseMatrix<double>& matrix) {
  *this = {};
  size_ = static_cast<int>(matrix.rows());
  outer_.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + size_ + 1);
  inner_.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
  elimination_ = Elimination::of(matrix);
  operations_ = elimination_.operations();
  first_row_.push_back(0);
  first_panel_.push_back(0);
  std::int64_t value_count = 0;
  for (const Supernode& node : elimination_.nodes) {
    const int parts = (node.width() + panel_width - 1) / panel_width;
    for (int part = 0; part < parts; ++part) {
      const int first = node.first + node.width() * part / parts;
      const int end = node.first + node.width() * (part + 1) / parts;
      first_column_.push_back(first);
      width_.push_back(end - first);
      panel_of_.insert(panel_of_.end(), end - first, static_cast<std::int32_t>(width_.size()) - 1);
      for (int j = end; j <= node.last; ++j) rows_.push_back(j);
      const auto below = elimination_.rows.begin() + node.first_row;
      rows_.insert(rows_.end(), below, below + node.row_count);
      first_value_.push_back(value_count);
      const auto row_count = static_cast<std::int64_t>(rows_.size()) - first_row_.back();
      value_count += (end - first) * (end - first + row_count);
      first_row_.push_back(static_cast<std::int64_t>(rows_.size()));
    }
    first_panel_.push_back(static_cast<std::int32_t>(width_.size()));
    node_of_.insert(node_of_.end(), parts, static_cast<std::int32_t>(first_panel_.size()) - 2);
  }
  first_value_.push_back(value_count);
}

// The panels of a supernode follow each other on a path, and those of a later one are closer to the root.
std::int32_t CholeskyFactor::meeting_of(std::int32_t a, std::int32_t b) const {
  while (a >= 0 && b >= 0 && node_of_[a] != node_of_[b]) {
    std::int32_t& earlier = a < b ? a : b;
    earlier = parent_of(first_panel_[node_of_[earlier] + 1] - 1);
  }
  return a >= 0 && b >= 0 ? std::max(a, b) : -1;
}

void CholeskyFactor::factorize(const Eigen::SparseMatrix<double>& matrix, Precision precision) {
  if (!has_pattern_of(matrix)) analyze(matrix);
  precision_ = precision;
  single_.resize(precision == Precision::single_precision ? first_value_.back() : 0);
  double_.resize(precision == Precision::double_precision ? first_value_.back() : 0);
  Room room;
  if (!renew(matrix, room))
    throw RunError(fmt::format("the stiffness matrix is not positive definite (unknown {})", room.failed_));
}

namespace {

// Appends numbers, each raised by an amount.
template <class List, class Number>
void append(List& list, const List& more, Number raise, std::size_t skip = 0) {
  for (std::size_t i = skip; i < more.size(); ++i)
    list.push_back(static_cast<typename List::value_type>(more[i] + raise));
}

}  // namespace

CholeskyFactor CholeskyFactor::block_diagonal(const std::vector<const CholeskyFactor*>& blocks) {
  CholeskyFactor all;
  all.first_panel_ = {0};
  all.first_row_ = all.first_value_ = {0};
  if (!blocks.empty()) all.precision_ = blocks.front()->precision_;
  for (const CholeskyFactor* block : blocks) {
    SUPPLE_CHECK(int(block->precision_), ==, int(all.precision_));
    const auto panels = static_cast<std::int32_t>(all.width_.size());
    const auto nodes = static_cast<std::int32_t>(all.first_panel_.size()) - 1;
    append(all.panel_of_, block->panel_of_, panels);
    append(all.node_of_, block->node_of_, nodes);
    append(all.first_panel_, block->first_panel_, panels, 1);
    append(all.first_column_, block->first_column_, all.size_);
    append(all.width_, block->width_, 0);
    append(all.first_row_, block->first_row_, all.rows_.size(), 1);
    append(all.rows_, block->rows_, all.size_);
    append(all.first_value_, block->first_value_, all.first_value_.back(), 1);
    all.single_.insert(all.single_.end(), block->single_.begin(), block->single_.end());
    all.double_.insert(all.double_.end(), block->double_.begin(), block->double_.end());
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
  room.columns_.resize(elimination_.most_column_numbers);
  room.fronts_->begin();
  for (const std::int32_t s : elimination_.order) {
    room.failed_ = room.fronts_->eliminate(matrix, s, room.columns_.data());
    if (room.failed_ >= 0) return false;
    precision_ == Precision::single_precision ? store_panels(s, room.columns_.data(), single_)
                                              : store_panels(s, room.columns_.data(), double_);
  }
  return true;
}

// Stores columns of a front as rows of its panels, with the diagonal inverted and 0 above it.
template <class T>
void CholeskyFactor::store_panels(int s, const double* columns, AlignedVector<T>& out) const {
  const Supernode& node = elimination_.nodes[s];
  const FrontShape front = node.front();
  for (int panel = first_panel_[s]; panel < first_panel_[s + 1]; ++panel) {
    const int first = first_column_[panel] - node.first, width = width_[panel];
    T* target = out.data() + first_value_[panel];
    for (int from = 0, to = 0; from < width; from = to) {  // columns of one strip
      const int strip = (first + from) / block_rows, block = block_rows * strip_width(front, strip);
      to = std::min(width, (strip + 1) * block_rows - first);
      const double* column = columns + strip_begin(front, strip) + (first + from) % block_rows * block_rows;
      const auto store_rows = [&](int row, int end) {
        for (int place = padded_place(front, row); row < end; ++row, ++place) {
          const double* source = column + (place / block_rows - strip) * block + place % block_rows;
          T* stored = target + std::int64_t(row - first) * width;
          for (int j = from; j < to; ++j) stored[j] = static_cast<T>(source[(j - from) * block_rows]);
        }
      };
      store_rows(first + from, front.pivots);
      store_rows(front.pivots, front.pivots + front.rows);
      for (int j = from; j < to; ++j) {
        for (int i = 0; i < j; ++i) target[i * width + j] = 0;
        target[j * width + j] = static_cast<T>(1 / column[(j - from) * block_rows + (first + j) % block_rows]);
      }
    }
  }
}

PanelsView CholeskyFactor::view() const {
  const void* values =
      precision_ == Precision::single_precision ? static_cast<const void*>(single_.data()) : double_.data();
  return {static_cast<int>(width_.size()),
          first_column_.data(),
          width_.data(),
          first_row_.data(),
          rows_.data(),
          first_value_.data(),
          values};
}

double solve_scale(const double* b, int count) {
  double largest = 0;
  for (int i = 0; i < count; ++i) largest = std::max(largest, std::abs(b[i]));
  return largest > 0 && std::isfinite(largest) ? std::exp2(-std::ilogb(largest)) : 1.0;
}

namespace {

template <class T, class Solve>
void solve_interleaved(int size, const double* b, double* x, T* four, double scale, const Solve& solve) {
  for (int i = 0; i < size; ++i) {
    for (int c = 0; c < 3; ++c) four[4 * i + c] = static_cast<T>(scale * b[3 * i + c]);
    four[4 * i + 3] = 0;
  }
  solve(four);
  for (int i = 0; i < size; ++i) {
    for (int c = 0; c < 3; ++c) x[3 * i + c] = static_cast<double>(four[4 * i + c]) / scale;
  }
}

}  // namespace

void CholeskyFactor::solve(const double* b, double* x, double* scratch) const {
  const PanelsView panels = view();
  if (precision_ == Precision::single_precision) {
    solve_interleaved(size_, b, x, reinterpret_cast<float*>(scratch), solve_scale(b, 3 * size_), [&](float* four) {
      linear_kernels().down_float(panels, nullptr, 0, four);
      linear_kernels().up_float(panels, nullptr, 0, four);
    });
  } else {
    solve_interleaved(size_, b, x, scratch, 1.0, [&](double* four) {
      linear_kernels().down_double(panels, nullptr, 0, four);
      linear_kernels().up_double(panels, nullptr, 0, four);
    });
  }
}

}  // namespace supple
