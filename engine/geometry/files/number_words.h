// Reads words as numbers. A word is a number only as a whole: `0x10`, `0,5` and `12abc` are none. Readers of model
// files share this, so that the same word is a number in all formats.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace supple {

// Returns the number that a word is, or nothing. Numbers with a fraction may have an exponent as Fortran writes it
// (1.0D0); those that are too small for a double are zero, and nan and inf are numbers here.
template <class Number>
std::optional<Number> number_of(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Number value{};
  const char* const last = word.data() + word.size();
  const auto [end, error] = std::from_chars(word.data(), last, value);
  if (end == last && error == std::errc()) return value;
  if constexpr (std::is_floating_point_v<Number>) {
    if (end == last && error == std::errc::result_out_of_range) {
      const std::size_t exponent = word.find_first_of("eE");
      if (exponent != std::string_view::npos && exponent + 1 < word.size() && word[exponent + 1] == '-')
        return Number(0);
    }
    const std::size_t exponent = word.find_first_of("dD");
    if (exponent == std::string_view::npos || exponent == 0 || word.find_first_of("eEnN") != std::string_view::npos)
      return std::nullopt;
    std::string plain(word);
    plain[exponent] = 'e';
    return number_of<Number>(std::string_view(plain));
  }
  return std::nullopt;
}

// Returns what is to be said of a word that is no number, after the word itself.
inline std::string why_no_number(std::string_view word) {
  std::string point(word);
  std::replace(point.begin(), point.end(), ',', '.');
  if (word.find(',') != std::string_view::npos && number_of<double>(point))
    return " (decimal commas are not read: " + point.substr(0, 40) + ")";
  return "";
}

}  // namespace supple
