#include "sim/cholesky.h"

#include <cholmod.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"

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

// Adjacent columns with (nearly) one pattern. Children are merged into their parents while the zeros that this stores
// stay few: the thresholds are CHOLMOD's (nrelax, zrelax), which our solve times confirm to within noise.
struct Supernode {
  int first, last;
  std::int64_t nonzeros;  // without the zeros that merging stores
};

std::vector<Supernode> find_supernodes(int size, const std::vector<int>& columns, const std::vector<int>& rows) {
  const auto below = [&](int j) { return columns[j + 1] - columns[j] - 1; };
  const auto parent = [&](int j) { return below(j) > 0 ? rows[columns[j] + 1] : size; };
  std::vector<Supernode> merged;
  for (int j = 0; j < size; ++j) {
    Supernode node{j, j, below(j) + 1};
    while (!merged.empty()) {
      const Supernode& child = merged.back();
      if (parent(child.last) != node.first) break;
      const std::int64_t wide = node.last - child.first + 1;
      const std::int64_t dense = wide * (wide + 1) / 2 + wide * below(node.last);
      const double zeros = static_cast<double>(dense - child.nonzeros - node.nonzeros) / static_cast<double>(dense);
      const bool few =
          zeros <= 0 || wide <= 4 || (wide <= 16 && zeros < 0.8) || (wide <= 48 && zeros < 0.1) || zeros < 0.05;
      if (!few) break;
      node = {child.first, node.last, child.nonzeros + node.nonzeros};
      merged.pop_back();
    }
    merged.push_back(node);
  }
  return merged;
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
  const auto factor = cholmod.hold(cholmod_analyze(&view, &cholmod.common));
  if (!factor) throw RunError("the stiffness matrix could not be ordered: out of memory");
  const int* order = static_cast<const int*>(factor->Perm);
  return {order, order + count};
}

CholeskyFactor::CholeskyFactor(const Eigen::SparseMatrix<double>& matrix, Precision precision)
    : size_(static_cast<int>(matrix.rows())), precision_(precision) {
  std::vector<int> columns(size_ + 1, 0), rows;
  std::vector<double> values;
  {
    Cholmod cholmod;
    cholmod.common.method[0].ordering = CHOLMOD_NATURAL;
    cholmod.common.postorder = 0;
    cholmod_sparse view = view_of(matrix, CHOLMOD_REAL);
    const auto factor = cholmod.hold(size_ > 0 ? cholmod_analyze(&view, &cholmod.common) : nullptr);
    if (size_ > 0) {
      if (!factor || !cholmod_factorize(&view, factor.get(), &cholmod.common))
        throw RunError("the stiffness matrix could not be factored: out of memory");
      if (cholmod.common.status == CHOLMOD_NOT_POSDEF || factor->minor < factor->n) {
        throw RunError(fmt::format("the stiffness matrix is not positive definite (unknown {})", factor->minor));
      }
      const int* begin = static_cast<const int*>(factor->p);
      const int* length = static_cast<const int*>(factor->nz);
      for (int j = 0; j < size_; ++j) {
        columns[j + 1] = columns[j] + length[j];
        const int* row = static_cast<const int*>(factor->i) + begin[j];
        const double* value = static_cast<const double*>(factor->x) + begin[j];
        rows.insert(rows.end(), row, row + length[j]);
        values.insert(values.end(), value, value + length[j]);
      }
    }
  }

  first_row_.push_back(0);
  std::int64_t value_count = 0;
  for (const Supernode& node : find_supernodes(size_, columns, rows)) {
    // Panels split a supernode into equal parts; the rows below a panel are the supernode's later columns and the rows
    // of its last.
    const int wide = node.last - node.first + 1;
    const int parts = (wide + panel_width - 1) / panel_width;
    for (int part = 0; part < parts; ++part) {
      const int first = node.first + wide * part / parts;
      const int end = node.first + wide * (part + 1) / parts;
      first_column_.push_back(first);
      width_.push_back(end - first);
      for (int j = end; j <= node.last; ++j) rows_.push_back(j);
      rows_.insert(rows_.end(), rows.begin() + columns[node.last] + 1, rows.begin() + columns[node.last + 1]);
      first_value_.push_back(value_count);
      const auto row_count = static_cast<std::int64_t>(rows_.size()) - first_row_.back();
      value_count += (end - first) * (end - first + row_count);
      first_row_.push_back(static_cast<std::int64_t>(rows_.size()));
    }
  }
  if (precision == Precision::single_precision) {
    single_.assign(value_count, 0.0f);
    fill(columns, rows, values, single_);
  } else {
    double_.assign(value_count, 0.0);
    fill(columns, rows, values, double_);
  }
}

template <class T>
void CholeskyFactor::fill(const std::vector<int>& columns, const std::vector<int>& rows,
                          const std::vector<double>& values, AlignedVector<T>& out) {
  for (std::size_t panel = 0; panel < width_.size(); ++panel) {
    const int first = first_column_[panel], width = width_[panel];
    T* triangle = out.data() + first_value_[panel];
    const auto below_begin = rows_.begin() + first_row_[panel];
    const auto below_end = rows_.begin() + first_row_[panel + 1];
    for (int j = first; j < first + width; ++j) {
      auto at = below_begin;
      for (int k = columns[j]; k < columns[j + 1]; ++k) {
        const int i = rows[k];
        if (i == j) {
          triangle[(i - first) * width + (j - first)] = static_cast<T>(1 / values[k]);
        } else if (i < first + width) {
          triangle[(i - first) * width + (j - first)] = static_cast<T>(values[k]);
        } else {
          at = std::lower_bound(at, below_end, i);
          SUPPLE_CHECK(*at, ==, i);
          triangle[width * width + (at - below_begin) * width + (j - first)] = static_cast<T>(values[k]);
        }
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
                      [&](float* four) { kernels().solve_float(panels, four); });
  } else {
    solve_interleaved(size_, b, x, scratch, 1.0, [&](double* four) { kernels().solve_double(panels, four); });
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
