// Compiled once for each instruction set; SUPPLE_VARIANT names it.
#include "sim/linear/linear_kernels.h"

#include "base/lanes.h"
#include "base/variants.h"

#if defined(__FMA__) || defined(__AVX__)
#include <immintrin.h>
#endif

namespace supple {
namespace {

// Adjacent columns that are brought up to date together: each number loaded from an earlier column serves them all.
constexpr int strip_width = 4;

// Columns first to first + width of a front lose what the `done` columns of L before them take from them, rows from
// `first` down (and up to lanes - 1 above, where nobody looks).
template <int width, int registers>
void update_rows(double* front, long stride, int first, int done, long row) {
  double* target = front + first * stride + row;
  Lanes sum[width][registers];
  for (int c = 0; c < width; ++c) {
    for (int r = 0; r < registers; ++r) sum[c][r] = Lanes::load_aligned(target + c * stride + r * lanes);
  }
  const double* source = front + row;
  const double* scale = front + first;
  for (int k = 0; k < done; ++k, source += stride, scale += stride) {
    Lanes known[registers];
    for (int r = 0; r < registers; ++r) known[r] = Lanes::load_aligned(source + r * lanes);
    for (int c = 0; c < width; ++c) {
      const Lanes factor(scale[c]);
      for (int r = 0; r < registers; ++r) sum[c][r] = fnma(factor, known[r], sum[c][r]);
    }
  }
  for (int c = 0; c < width; ++c) {
    for (int r = 0; r < registers; ++r) sum[c][r].store_aligned(target + c * stride + r * lanes);
  }
}

template <int width>
void update_strip(double* front, long stride, int first, int done) {
  long row = first / lanes * lanes;
  for (; row + 2 * lanes <= stride; row += 2 * lanes) update_rows<width, 2>(front, stride, first, done, row);
  for (; row < stride; row += lanes) update_rows<width, 1>(front, stride, first, done, row);
}

using StripUpdate = void (*)(double*, long, int, int);

// The columns of a strip, which know of all before the strip, become columns of L.
int factor_strip(double* front, long stride, int first, int width) {
  for (int j = first; j < first + width; ++j) {
    double* column = front + j * stride;
    const long begin = j / lanes * lanes;
    for (int k = first; k < j; ++k) {
      const double* known = front + k * stride;
      const Lanes factor(known[j]);
      for (long i = begin; i < stride; i += lanes)
        fnma(factor, Lanes::load_aligned(known + i), Lanes::load_aligned(column + i)).store_aligned(column + i);
    }
    if (!(column[j] > 0)) return j;
    const Lanes scale = Lanes(1.0) / sqrt(Lanes(column[j]));
    for (long i = begin; i < stride; i += lanes) (Lanes::load_aligned(column + i) * scale).store_aligned(column + i);
  }
  return -1;
}

int eliminate(double* front, long stride, int size, int pivots) {
  static constexpr StripUpdate update[strip_width] = {update_strip<1>, update_strip<2>, update_strip<3>,
                                                      update_strip<4>};
  for (int first = 0; first < size;) {
    const int left = (first < pivots ? pivots : size) - first;
    const int width = left < strip_width ? left : strip_width;
    const int done = first < pivots ? first : pivots;
    if (done > 0) update[width - 1](front, stride, first, done);
    if (first < pivots) {
      const int failed = factor_strip(front, stride, first, width);
      if (failed >= 0) return failed;
    }
    first += width;
  }
  return -1;
}

// Four right-hand sides side by side: x, y, z and a spare that keeps loads whole.
template <class T>
struct Four {
  typedef T Register __attribute__((vector_size(4 * sizeof(T))));
  Register v;

  static Four load(const T* p) {
    Four f;
    __builtin_memcpy(&f.v, p, sizeof f.v);
    return f;
  }
  void store(T* p) const { __builtin_memcpy(p, &v, sizeof v); }
  // this -= a * x
  void subtract_scaled(T a, const Four& x) {
#if defined(__FMA__)
    if constexpr (sizeof(T) == 4) {
      v = _mm_fnmadd_ps(_mm_set1_ps(a), x.v, v);
    } else {
      v = _mm256_fnmadd_pd(_mm256_set1_pd(a), x.v, v);
    }
#else
    v -= a * x.v;
#endif
  }
};

template <class T, int width>
void forward(const PanelsView& view, int panel, T* x) {
  const T* value = static_cast<const T*>(view.values) + view.first_value[panel];
  T* top = x + 4 * long(view.first_column[panel]);
  Four<T> known[width];
  for (int j = 0; j < width; ++j) {
    Four<T> sum = Four<T>::load(top + 4 * j);
    for (int k = 0; k < j; ++k) sum.subtract_scaled(value[j * width + k], known[k]);
    sum.v *= value[j * width + j];
    sum.store(top + 4 * j);
    known[j] = sum;
  }
  value += width * width;
  const std::int32_t* rows = view.rows + view.first_row[panel];
  const long count = view.first_row[panel + 1] - view.first_row[panel];
  for (long i = 0; i < count; ++i, value += width) {
    T* target = x + 4 * long(rows[i]);
    Four<T> sum = Four<T>::load(target);
    for (int k = 0; k < width; ++k) sum.subtract_scaled(value[k], known[k]);
    sum.store(target);
  }
}

template <class T, int width>
void backward(const PanelsView& view, int panel, T* x) {
  const T* triangle = static_cast<const T*>(view.values) + view.first_value[panel];
  const T* value = triangle + width * width;
  T* top = x + 4 * long(view.first_column[panel]);
  Four<T> sum[width];
  for (int j = 0; j < width; ++j) sum[j] = Four<T>::load(top + 4 * j);
  const std::int32_t* rows = view.rows + view.first_row[panel];
  const long count = view.first_row[panel + 1] - view.first_row[panel];
  for (long i = 0; i < count; ++i, value += width) {
    const Four<T> known = Four<T>::load(x + 4 * long(rows[i]));
    for (int k = 0; k < width; ++k) sum[k].subtract_scaled(value[k], known);
  }
  for (int j = width - 1; j >= 0; --j) {
    for (int k = j + 1; k < width; ++k) sum[j].subtract_scaled(triangle[k * width + j], sum[k]);
    sum[j].v *= triangle[j * width + j];
    sum[j].store(top + 4 * j);
  }
}

template <class T>
using PanelStep = void (*)(const PanelsView&, int, T*);

template <class T>
void solve(const PanelsView& view, T* x) {
  static constexpr PanelStep<T> down[panel_width] = {forward<T, 1>, forward<T, 2>, forward<T, 3>, forward<T, 4>,
                                                     forward<T, 5>, forward<T, 6>, forward<T, 7>, forward<T, 8>};
  static constexpr PanelStep<T> up[panel_width] = {backward<T, 1>, backward<T, 2>, backward<T, 3>, backward<T, 4>,
                                                   backward<T, 5>, backward<T, 6>, backward<T, 7>, backward<T, 8>};
  for (int panel = 0; panel < view.panels; ++panel) down[view.width[panel] - 1](view, panel, x);
  for (int panel = view.panels - 1; panel >= 0; --panel) up[view.width[panel] - 1](view, panel, x);
}

void dots(const double* const* a, int count, const double* b, long begin, long end, double* result) {
  for (int i = 0; i < count; ++i) {
    const double* v = a[i];
    Lanes s0(0.0), s1(0.0), s2(0.0), s3(0.0);
    long at = begin;
    for (; at + 4 * lanes <= end; at += 4 * lanes) {
      s0 = fma(Lanes::load_unaligned(v + at), Lanes::load_unaligned(b + at), s0);
      s1 = fma(Lanes::load_unaligned(v + at + lanes), Lanes::load_unaligned(b + at + lanes), s1);
      s2 = fma(Lanes::load_unaligned(v + at + 2 * lanes), Lanes::load_unaligned(b + at + 2 * lanes), s2);
      s3 = fma(Lanes::load_unaligned(v + at + 3 * lanes), Lanes::load_unaligned(b + at + 3 * lanes), s3);
    }
    double sum = sum_in_order((s0 + s1) + (s2 + s3));
    for (; at < end; ++at) sum += v[at] * b[at];
    result[i] = sum;
  }
}

void add_scaled(const double* const* a, const double* c, int count, double* r, long begin, long end) {
  long at = begin;
  for (; at + lanes <= end; at += lanes) {
    Lanes sum = Lanes::load_unaligned(r + at);
    for (int i = 0; i < count; ++i) sum = fma(Lanes(c[i]), Lanes::load_unaligned(a[i] + at), sum);
    sum.store_unaligned(r + at);
  }
  for (; at < end; ++at) {
    for (int i = 0; i < count; ++i) r[at] += c[i] * a[i][at];
  }
}

}  // namespace

extern const LinearKernels SUPPLE_TABLE(linear);
const LinearKernels SUPPLE_TABLE(linear) = {eliminate, solve<float>, solve<double>, dots, add_scaled};

}  // namespace supple
