#include "sim/linear/parted_solve.h"

#include <algorithm>
#include <cmath>

namespace supple {

FactorPart paths_to_root(const CholeskyFactor& factor, const std::vector<std::int32_t>& unknowns) {
  std::vector<bool> met(factor.view().strip_count, false);
  FactorPart part;
  for (const std::int32_t unknown : unknowns) {
    for (std::int32_t strip = factor.strip_of(unknown); strip >= 0 && !met[strip]; strip = factor.parent_of(strip)) {
      met[strip] = true;
      part.push_back(strip);
    }
  }
  std::sort(part.begin(), part.end());
  return part;
}

namespace {

// Holds the buffers of a solve, in its precision.
template <class T>
struct Buffers {
  const CholeskyFactor& factor;
  T *scratch, *main, *other;
  long size = factor.size();

  Buffers(const CholeskyFactor& of, void* room)
      : factor(of),
        scratch(static_cast<T*>(room)),
        main(scratch + of.front_numbers()),
        other(main + 4 * std::size_t(of.size())) {}
  static std::size_t numbers(const CholeskyFactor& of) { return of.front_numbers() + 8 * std::size_t(of.size()); }

  void down(const FactorPart* part, T* x) const { factor.down(part, x, scratch); }
  void up(const FactorPart* part, T* x) const { factor.up(part, x, scratch); }
  // Calls work(first, end) for the numbers of each strip of a part.
  template <class Work>
  void numbers_of(const FactorPart& part, const Work& work) const {
    for (const std::int32_t strip : part) {
      const long first = 4 * long(factor.first_column(strip));
      work(first, first + 4 * factor.width(strip));
    }
  }
};

std::size_t room_for(const CholeskyFactor& factor) {
  return factor.precision() == Precision::single_precision ? (Buffers<float>::numbers(factor) + 1) / 2
                                                           : Buffers<double>::numbers(factor);
}

}  // namespace

template <class Work>
void PartedSolve::by_precision(const Work& work) {
  factor_->precision() == Precision::single_precision ? work(Buffers<float>(*factor_, room_.data()))
                                                      : work(Buffers<double>(*factor_, room_.data()));
}

void PartedSolve::begin(const CholeskyFactor& factor, const double* b) {
  factor_ = &factor;
  const bool single = factor.precision() == Precision::single_precision;
  scale_ = single ? solve_scale(b, 3 * factor.size()) : 1.0;
  room_.resize(room_for(factor));
  by_precision([&]<class T>(const Buffers<T>& k) {
    for (long i = 0; i < k.size; ++i) {
      for (int c = 0; c < 3; ++c) k.main[4 * i + c] = static_cast<T>(scale_ * b[3 * i + c]);
      k.main[4 * i + 3] = 0;
    }
    k.down(nullptr, k.main);
  });
}

void PartedSolve::begin_from_zero(const CholeskyFactor& factor, double magnitude) {
  factor_ = &factor;
  const bool single = factor.precision() == Precision::single_precision;
  scale_ = single ? solve_scale(&magnitude, 1) : 1.0;
  room_.resize(room_for(factor));
  by_precision([&]<class T>(const Buffers<T>& k) { std::fill_n(k.main, 4 * k.size, T(0)); });
}

void PartedSolve::look(const FactorPart& part) {
  by_precision([&](const auto& k) {
    k.numbers_of(part, [&](long first, long end) { std::copy(k.main + first, k.main + end, k.other + first); });
    k.up(&part, k.other);
  });
}

Vec3 PartedSolve::seen(int unknown) const {
  Vec3 value;
  const_cast<PartedSolve*>(this)->by_precision([&](const auto& k) {
    for (int c = 0; c < 3; ++c) value[c] = static_cast<double>(k.other[4 * long(unknown) + c]) / scale_;
  });
  return value;
}

void PartedSolve::clear_addition(const FactorPart& part) {
  by_precision([&]<class T>(const Buffers<T>& k) {
    k.numbers_of(part, [&](long first, long end) { std::fill(k.other + first, k.other + end, T(0)); });
  });
}

void PartedSolve::add(int unknown, const Vec3& value) {
  by_precision([&]<class T>(const Buffers<T>& k) {
    for (int c = 0; c < 3; ++c) k.other[4 * long(unknown) + c] += static_cast<T>(scale_ * value[c]);
  });
}

void PartedSolve::pass_on(const FactorPart& part) {
  by_precision([&](const auto& k) {
    k.down(&part, k.other);
    k.numbers_of(part, [&](long first, long end) {
      for (long i = first; i < end; ++i) k.main[i] += k.other[i];
    });
  });
}

void PartedSolve::finish(double* x) {
  by_precision([&](const auto& k) {
    k.up(nullptr, k.main);
    for (long i = 0; i < k.size; ++i) {
      for (int c = 0; c < 3; ++c) x[3 * i + c] = static_cast<double>(k.main[4 * i + c]) / scale_;
    }
  });
}

}  // namespace supple
