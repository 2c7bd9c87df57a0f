#include "base/frame_rate.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "base/error.h"

namespace supple {
namespace {

constexpr long long largest_part = 1'000'000'000;  // for numerator and denominator: ffmpeg keeps both in 32 bits

struct Fraction {
  long long numerator, denominator;
};

// Returns the rate of television that a number with two or three digits after the point stands for.
std::optional<Fraction> television_rate(double per_second) {
  for (const int whole : {24, 30, 48, 60, 120}) {
    const double exact = whole * 1000.0 / 1001;
    for (const double digits : {100.0, 1000.0}) {
      if (std::abs(per_second - std::round(exact * digits) / digits) < 1e-9) return Fraction{whole * 1000, 1001};
    }
  }
  return std::nullopt;
}

// Returns the simplest fraction that is the same number in double precision, or the nearest one whose parts are at most
// largest_part. Tries the convergents of the continued fraction, one after the other.
Fraction simplest(double value) {
  Fraction before{0, 1}, best{1, 0};
  double rest = value;
  for (int term = 0; term < 64; ++term) {
    const double whole = std::floor(rest);
    const double numerator = whole * static_cast<double>(best.numerator) + static_cast<double>(before.numerator);
    const double denominator = whole * static_cast<double>(best.denominator) + static_cast<double>(before.denominator);
    if (numerator > largest_part || denominator > largest_part) break;
    before = best;
    best = {static_cast<long long>(numerator), static_cast<long long>(denominator)};
    if (numerator / denominator == value || rest == whole) break;
    rest = 1 / (rest - whole);
  }
  return best;
}

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<long long> part_of_fraction(std::string_view text) {
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > largest_part)
    return std::nullopt;
  return value;
}

}  // namespace

FrameRate::FrameRate(long long numerator, long long denominator) {
  const long long common = std::gcd(numerator, denominator);
  numerator_ = static_cast<int>(numerator / common);
  denominator_ = static_cast<int>(denominator / common);
}

FrameRate::FrameRate(double per_second) {
  SUPPLE_CHECK(per_second, >=, 1.0 / largest_part);
  SUPPLE_CHECK(per_second, <=, double(largest_part));
  const Fraction exact = television_rate(per_second).value_or(simplest(per_second));
  *this = FrameRate(exact.numerator, exact.denominator);
}

std::optional<FrameRate> FrameRate::parse(std::string_view text) {
  if (const std::size_t bar = text.find('/'); bar != text.npos) {
    const auto numerator = part_of_fraction(text.substr(0, bar)), denominator = part_of_fraction(text.substr(bar + 1));
    if (!numerator || !denominator) return std::nullopt;
    return FrameRate(*numerator, *denominator);
  }
  const std::optional<double> value = number_of(text);
  if (!value || !(*value >= 1.0 / largest_part && *value <= largest_part)) return std::nullopt;
  return FrameRate(*value);
}

FrameRate FrameRate::over(int every) const {
  const long long common = std::gcd(static_cast<long long>(numerator_), static_cast<long long>(every));
  return {numerator_ / common, denominator_ * (every / common)};
}

std::string FrameRate::text() const {
  constexpr int thousand = 1000;
  if (thousand % denominator_ == 0) return fmt::format("{}", numerator_ / static_cast<double>(denominator_));
  return fmt::format("{}/{}", numerator_, denominator_);
}

}  // namespace supple
