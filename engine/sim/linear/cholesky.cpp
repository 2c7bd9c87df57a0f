#include "sim/linear/cholesky.h"

#include <cholmod.h>
#include <dlfcn.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/signals.h"

namespace supple {
namespace {

// CHOLMOD's workspace, and its matrices by unique_ptr.
struct Cholmod {
  cholmod_common common;
  Cholmod() {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_ll = 1;
    common.final_pack = 1;
    common.final_monotonic = 1;
    common.print = 0;
    common.nmethods = 1;
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

// A view of an Eigen matrix's lower triangle.
cholmod_sparse view_of(const Eigen::SparseMatrix<double>& matrix, int xtype) {
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(matrix.rows());
  view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
  view.p = const_cast<int*>(matrix.outerIndexPtr());
  view.i = const_cast<int*>(matrix.innerIndexPtr());
  view.x = const_cast<double*>(matrix.valuePtr());
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = xtype;
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
  cholmod.common.method[0].ordering = CHOLMOD_METIS;
  cholmod_sparse view = view_of(pattern, CHOLMOD_PATTERN);
  view.x = nullptr;
  // METIS takes SIGTERM for an error of its own and gives up; CHOLMOD then goes on with another order, whose last bits
  // differ, and the signal is lost.
  const SignalsWait meanwhile;
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
      for (int j = end; j <= node.last; ++j) rows_.push_back(j);
      const auto below = elimination_.rows.begin() + node.first_row;
      rows_.insert(rows_.end(), below, below + node.row_count);
      first_value_.push_back(value_count);
      const auto row_count = static_cast<std::int64_t>(rows_.size()) - first_row_.back();
      value_count += (end - first) * (end - first + row_count);
      first_row_.push_back(static_cast<std::int64_t>(rows_.size()));
    }
    first_panel_.push_back(static_cast<std::int32_t>(width_.size()));
  }
  first_value_.push_back(value_count);
}

namespace {

// What the fronts are made of: the one that is worked on, and the update matrices that wait for their parents.
class Fronts {
 public:
  Fronts(const Elimination& elimination, const Eigen::SparseMatrix<double>& matrix)
      : elimination_(elimination),
        matrix_(matrix),
        place_(elimination.size),
        front_(padded_rows(elimination.largest_front) * elimination.largest_front),
        stack_(elimination.deepest_stack) {
    waiting_.reserve(elimination.nodes.size());
  }

  // The front of a node after elimination of its columns: a column has padded_rows(front()) numbers.
  const double* eliminate(int s) {
    const Supernode& node = elimination_.nodes[s];
    assemble(s);
    const int failed = linear_kernels().eliminate(front_.data(), padded_rows(node.front()), node.front(), node.width());
    if (failed >= 0)
      throw RunError(fmt::format("the stiffness matrix is not positive definite (unknown {})", node.first + failed));
    if (node.parent >= 0) leave_update(s);
    return front_.data();
  }

 private:
  // Of the matrix what the node's columns hold, and what its children left on the stack.
  void assemble(int s) {
    const Supernode& node = elimination_.nodes[s];
    const std::int64_t stride = padded_rows(node.front());
    std::fill_n(front_.begin(), stride * node.front(), 0.0);
    for (int j = 0; j < node.width(); ++j) place_[node.first + j] = j;
    const std::int32_t* rows = &elimination_.rows[node.first_row];
    for (int i = 0; i < node.row_count; ++i) place_[rows[i]] = node.width() + i;
    for (int j = 0; j < node.width(); ++j) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix_, node.first + j); entry; ++entry)
        front_[j * stride + place_[entry.row()]] = entry.value();
    }
    while (!waiting_.empty() && elimination_.nodes[waiting_.back()].parent == s) {
      add_update(elimination_.nodes[waiting_.back()], stride);
      waiting_.pop_back();
    }
  }

  void add_update(const Supernode& child, std::int64_t stride) {
    const std::int64_t child_stride = padded_rows(child.row_count);
    stacked_ -= child_stride * child.row_count;
    const double* update = &stack_[stacked_];
    const std::int32_t* rows = &elimination_.rows[child.first_row];
    target_.resize(child.row_count);
    for (int i = 0; i < child.row_count; ++i) target_[i] = place_[rows[i]];
    for (int j = 0; j < child.row_count; ++j, update += child_stride) {
      double* column = &front_[target_[j] * stride];
      for (int i = j; i < child.row_count; ++i) column[target_[i]] += update[i];
    }
  }

  void leave_update(int s) {
    const Supernode& node = elimination_.nodes[s];
    const std::int64_t stride = padded_rows(node.front()), own_stride = padded_rows(node.row_count);
    for (int j = 0; j < node.row_count; ++j) {
      const double* column = &front_[(node.width() + j) * stride + node.width()];
      std::copy(column + j, column + node.row_count, &stack_[stacked_ + j * own_stride + j]);
    }
    stacked_ += own_stride * node.row_count;
    waiting_.push_back(s);
  }

  const Elimination& elimination_;
  const Eigen::SparseMatrix<double>& matrix_;
  std::vector<std::int32_t> place_, target_, waiting_;  // row of the front by unknown; by row of a child; nodes
  AlignedVector<double> front_, stack_;
  std::int64_t stacked_ = 0;  // numbers on the stack
};

}  // namespace

void CholeskyFactor::factorize(const Eigen::SparseMatrix<double>& matrix, Precision precision) {
  if (!has_pattern_of(matrix)) analyze(matrix);
  precision_ = precision;
  single_.resize(precision == Precision::single_precision ? first_value_.back() : 0);
  double_.resize(precision == Precision::double_precision ? first_value_.back() : 0);
  Fronts fronts(elimination_, matrix);
  for (const std::int32_t s : elimination_.order) {
    const double* front = fronts.eliminate(s);
    precision == Precision::single_precision ? store_panels(s, front, single_) : store_panels(s, front, double_);
  }
}

// Columns of a front become rows of its panels, the diagonal inverted; above it 0.
template <class T>
void CholeskyFactor::store_panels(int s, const double* front, AlignedVector<T>& out) const {
  const Supernode& node = elimination_.nodes[s];
  const std::int64_t stride = padded_rows(node.front());
  for (int panel = first_panel_[s]; panel < first_panel_[s + 1]; ++panel) {
    const int first = first_column_[panel] - node.first, width = width_[panel];
    const double* source = front + first * stride + first;
    T* target = out.data() + first_value_[panel];
    for (int i = 0; i < width; ++i) {
      for (int j = 0; j < width; ++j)
        target[i * width + j] = static_cast<T>(j > i    ? 0.0
                                               : j == i ? 1 / source[j * stride + j]
                                                        : source[j * stride + i]);
    }
    for (int i = width; i < node.front() - first; ++i) {
      for (int j = 0; j < width; ++j) target[i * width + j] = static_cast<T>(source[j * stride + i]);
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

namespace {

// A power of two that brings the largest entry near 1, so that single precision neither overflows nor falls into
// denormals.
double scale_of(const double* b, int count) {
  double largest = 0;
  for (int i = 0; i < count; ++i) largest = std::max(largest, std::abs(b[i]));
  return largest > 0 && std::isfinite(largest) ? std::exp2(-std::ilogb(largest)) : 1.0;
}

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
    solve_interleaved(size_, b, x, reinterpret_cast<float*>(scratch), scale_of(b, 3 * size_),
                      [&](float* four) { linear_kernels().solve_float(panels, four); });
  } else {
    solve_interleaved(size_, b, x, scratch, 1.0, [&](double* four) { linear_kernels().solve_double(panels, four); });
  }
}

struct ChangingFactor::Parts {
  Cholmod cholmod;
  cholmod_factor* factor = nullptr;
  cholmod_dense *solution = nullptr, *y = nullptr, *e = nullptr;  // kept from solve to solve
  Parts() {
    cholmod.common.supernodal = CHOLMOD_SUPERNODAL;
    cholmod.common.method[0].ordering = CHOLMOD_NATURAL;
    cholmod.common.postorder = 1;
  }
  ~Parts() {
    cholmod_free_dense(&solution, &cholmod.common);
    cholmod_free_dense(&y, &cholmod.common);
    cholmod_free_dense(&e, &cholmod.common);
    cholmod_free_factor(&factor, &cholmod.common);
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
};

ChangingFactor::ChangingFactor() = default;
ChangingFactor::~ChangingFactor() = default;
ChangingFactor::ChangingFactor(ChangingFactor&&) noexcept = default;
ChangingFactor& ChangingFactor::operator=(ChangingFactor&&) noexcept = default;

void ChangingFactor::analyze(const Eigen::SparseMatrix<double>& matrix) {
  parts_ = std::make_unique<Parts>();
  cholmod_sparse view = view_of(matrix, CHOLMOD_REAL);
  parts_->factor = cholmod_analyze(&view, &parts_->cholmod.common);
  if (parts_->factor == nullptr) throw RunError("a matrix could not be analysed: out of memory");
}

namespace {

// CHOLMOD's supernodal code opens OpenMP's parallel regions for small loops, whose spinning threads cost more than the
// whole factorisation where cores are shared. No region of this thread becomes active any more.
void forbid_openmp_threads() {
  using SetLevels = void (*)(int);
  static const auto set_levels = reinterpret_cast<SetLevels>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"));
  if (set_levels != nullptr) set_levels(0);
}

}  // namespace

bool ChangingFactor::factorize(const Eigen::SparseMatrix<double>& matrix) {
  forbid_openmp_threads();
  cholmod_sparse view = view_of(matrix, CHOLMOD_REAL);
  if (!cholmod_factorize(&view, parts_->factor, &parts_->cholmod.common))
    throw RunError("a matrix could not be factored: out of memory");
  return parts_->cholmod.common.status != CHOLMOD_NOT_POSDEF && parts_->factor->minor == parts_->factor->n;
}

void ChangingFactor::solve(const double* b, double* x) {
  forbid_openmp_threads();
  cholmod_dense right{};
  right.nrow = right.nzmax = right.d = parts_->factor->n;
  right.ncol = 1;
  right.x = const_cast<double*>(b);
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  Parts& p = *parts_;
  if (!cholmod_solve2(CHOLMOD_A, p.factor, &right, nullptr, &p.solution, nullptr, &p.y, &p.e, &p.cholmod.common))
    throw RunError("a linear system could not be solved: out of memory");
  const double* found = static_cast<const double*>(p.solution->x);
  std::copy(found, found + p.factor->n, x);
}

std::int64_t ChangingFactor::stored_numbers() const {
  return parts_ && parts_->factor ? static_cast<std::int64_t>(parts_->factor->xsize) : 0;
}

}  // namespace supple
