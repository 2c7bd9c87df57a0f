// Reads mesh files word by word. Only the readers of mesh files use it.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/files/number_words.h"
#include "geometry/meshes/mesh.h"

namespace supple {

// Splits a text into words and keeps their line numbers; '#' starts a comment.
class MeshWords {
 public:
  MeshWords(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name)) {}

  // Returns the next word, or an empty one at the end.
  std::string_view next() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') ++line_;
      if (c == '#') {
        while (at_ + 1 < text_.size() && text_[at_ + 1] != '\n') ++at_;
      } else if (!is_space(c)) {
        break;
      }
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_space(text_[at_]) && text_[at_] != '#') ++at_;
    return std::string_view(text_).substr(begin, at_ - begin);
  }

  std::size_t bytes_left() const { return text_.size() - at_; }
  int line() const { return line_; }

  [[noreturn]] void refuse(const std::string& message) const { throw InputError({Problem{{name_, line_}, message}}); }

  template <class Number>
  Number number(std::string_view what) {
    const std::string_view word = next();
    if (word.empty() && announced_ > rows_) {
      refuse(fmt::format("{} {} announced, but the file ends after {}: {} should stand here", announced_, section_,
                         rows_, what));
    }
    if (word.empty()) refuse(fmt::format("the file ends where {} should stand", what));
    const auto value = number_of<Number>(word);
    if (!value) refuse(fmt::format("'{}' is not {}{}", word.substr(0, 40), what, why_no_number(word)));
    if constexpr (std::is_floating_point_v<Number>) {
      if (!std::isfinite(*value)) refuse(fmt::format("{} is not finite ({})", what, word.substr(0, 40)));
    }
    return *value;
  }

  // Reads a section's count and refuses it when the rest of the file could not hold that many rows.
  Eigen::Index count(std::string_view section, std::size_t fewest_bytes_a_row) {
    const auto value = number<long long>(fmt::format("the number of {}", section));
    if (value < 0 || static_cast<unsigned long long>(value) > bytes_left() / fewest_bytes_a_row + 1) {
      refuse(fmt::format("{} {} announced, but the file has room for at most {}", value, section,
                         bytes_left() / fewest_bytes_a_row));
    }
    section_ = section;
    announced_ = static_cast<Eigen::Index>(value);
    rows_ = 0;
    return announced_;
  }

  // Counts one more of the announced rows as complete; messages say how many are.
  void end_row() { ++rows_; }

  // Refuses a number that follows the announced rows: there are more of them. numbers_a_row: 0 where rows are not
  // equally long and each has a line of its own.
  void refuse_further_rows(int numbers_a_row) {
    const std::size_t start = at_;
    const int first_line = line_;
    Eigen::Index numbers = 0, lines = 0;
    int counted = 0;
    for (std::string_view word = next(); is_number(word); word = next()) {
      ++numbers;
      if (line_ != counted) ++lines;
      if (counted == 0 || line_ != counted) counted = line_;
    }
    at_ = start;
    line_ = first_line;
    const Eigen::Index rows = numbers_a_row > 0 ? (numbers + numbers_a_row - 1) / numbers_a_row : lines;
    if (rows == 0 || announced_ == 0) return;
    (void)next();
    refuse(fmt::format("{} {} announced, but the file holds {}", announced_, section_, announced_ + rows));
  }

  // Skips the rest of the line.
  void skip_line() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }

  // Passes over the rest of the line, on which only numbers may stand.
  void skip_numbers(std::string_view what) {
    while (!at_line_end()) (void)number<double>(what);
  }

  // Tells whether nothing but spaces and a comment stands before the next line.
  bool at_line_end() const {
    std::size_t at = at_;
    while (at < text_.size() && text_[at] != '\n' && is_space(text_[at])) ++at;
    return at >= text_.size() || text_[at] == '\n' || text_[at] == '#';
  }

  bool at_end() const { return at_ >= text_.size(); }

  // Goes on to the next line.
  void next_line() {
    skip_line();
    if (at_ < text_.size()) ++at_, ++line_;
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

  static bool is_number(std::string_view word) { return number_of<double>(word).has_value(); }

  std::string text_;
  std::string name_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::string section_;                    // what was announced last
  Eigen::Index announced_ = 0, rows_ = 0;  // how many rows of it were announced, and how many are complete
};

}  // namespace supple
