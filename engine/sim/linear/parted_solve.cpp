#include "sim/linear/parted_solve.h"

#include <algorithm>
#include <cmath>

namespace supple {

FactorPart paths_to_root(const CholeskyFactor& factor, const std::vector<std::int32_t>& unknowns) {
  std::vector<bool> met(factor.view().panels, false);
  FactorPart part;
  for (const std::int32_t unknown : unknowns) {
    for (std::int32_t panel = factor.panel_of(unknown); panel >= 0 && !met[panel]; panel = factor.parent_of(panel)) {
      met[panel] = true;
      part.push_back(panel);
    }
  }
  std::sort(part.begin(), part.end());
  return part;
}

namespace {

// Holds the two buffers of a solve, and the kernels of its precision.
template <class T>
struct Buffers {
  PanelsView view;
  long size;
  T* main;
  T* other;

  void down(const FactorPart* part, T* x) const {
    const std::int32_t* list = part != nullptr ? part->data() : nullptr;
    const int count = part != nullptr ? static_cast<int>(part->size()) : 0;
    if constexpr (sizeof(T) == 4) {
      linear_kernels().down_float(view, list, count, x);
    } else {
      linear_kernels().down_double(view, list, count, x);
    }
  }
  void up(const FactorPart* part, T* x) const {
    const std::int32_t* list = part != nullptr ? part->data() : nullptr;
    const int count = part != nullptr ? static_cast<int>(part->size()) : 0;
    if constexpr (sizeof(T) == 4) {
      linear_kernels().up_float(view, list, count, x);
    } else {
      linear_kernels().up_double(view, list, count, x);
    }
  }
  // Calls work(first, end) for the numbers of each panel of a part.
  template <class Work>
  void numbers_of(const FactorPart& part, const Work& work) const {
    for (const std::int32_t panel : part) {
      const long first = 4 * long(view.first_column[panel]);
      work(first, first + 4 * view.width[panel]);
    }
  }
};

}  // namespace

template <class Work>
void PartedSolve::by_precision(const Work& work) {
  const long size = factor_->size();
  const PanelsView view = factor_->view();
  if (factor_->precision() == Precision::single_precision) {
    float* room = reinterpret_cast<float*>(room_.data());
    work(Buffers<float>{view, size, room, room + 4 * size});
  } else {
    work(Buffers<double>{view, size, room_.data(), room_.data() + 4 * size});
  }
}

void PartedSolve::begin(const CholeskyFactor& factor, const double* b) {
  factor_ = &factor;
  const bool single = factor.precision() == Precision::single_precision;
  scale_ = single ? solve_scale(b, 3 * factor.size()) : 1.0;
  room_.resize((single ? 4 : 8) * std::size_t(factor.size()));
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
  room_.resize((single ? 4 : 8) * std::size_t(factor.size()));
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
