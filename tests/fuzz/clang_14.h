// Included before all else where clang builds: Debian 12's clang deduces no template arguments of aggregates
// (P1816, C++20), which the tables of names rely on (base/names.h). It also refuses what the engine therefore goes
// without: std::ranges::unique and equal_range, which return a subrange, lambdas that capture structured bindings, and
// __builtin_shuffle.
#pragma once

#if __cplusplus >= 202002L  // CMake tries the compiler with its own default first, which knows no deduction at all
namespace supple {

template <class E>
struct Name;
template <class E>
Name(E, const char*) -> Name<E>;

}  // namespace supple
#endif
