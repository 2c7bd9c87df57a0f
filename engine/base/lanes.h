// Defines a register of the vector unit, for the hot loops. Only the files that are compiled once for each instruction
// set include this header: everything here has internal linkage, so that nothing compiled for a wide machine can be
// linked into the code for a narrow one.
#pragma once

#include <xsimd/xsimd.hpp>

#if defined(__AVX512F__)
// Version 8.1 of xsimd multiplies and adds in two instructions on machines with AVX-512. These overloads, which are
// more constrained than its own ones, do it in one, as its other variants do.
namespace xsimd {
template <class A>
concept Avx512 = std::is_base_of_v<avx512f, A>;
template <Avx512 A>
batch<double, A> fma(const batch<double, A>& x, const batch<double, A>& y, const batch<double, A>& z) noexcept {
  return _mm512_fmadd_pd(x, y, z);
}
template <Avx512 A>
batch<double, A> fnma(const batch<double, A>& x, const batch<double, A>& y, const batch<double, A>& z) noexcept {
  return _mm512_fnmadd_pd(x, y, z);
}
template <Avx512 A>
batch<float, A> fma(const batch<float, A>& x, const batch<float, A>& y, const batch<float, A>& z) noexcept {
  return _mm512_fmadd_ps(x, y, z);
}
template <Avx512 A>
batch<float, A> fnma(const batch<float, A>& x, const batch<float, A>& y, const batch<float, A>& z) noexcept {
  return _mm512_fnmadd_ps(x, y, z);
}
}  // namespace xsimd
#endif

namespace supple {
namespace {

using Lanes = xsimd::batch<double>;
constexpr int lanes = static_cast<int>(Lanes::size);

// Sums the lanes in their order, so that the order of a sum is the order of the elements.
[[maybe_unused]] double sum_in_order(const Lanes& v) {
  alignas(64) double value[lanes];
  v.store_aligned(value);
  double sum = value[0];
  for (int i = 1; i < lanes; ++i) sum += value[i];
  return sum;
}

}  // namespace
}  // namespace supple
