#include "geometry/files/text_rows.h"

#include <fmt/core.h>

#include "base/error.h"
#include "geometry/files/number_words.h"

namespace supple {

TextRows::TextRows(std::string_view text, std::string name, Rules rules)
    : text_(text), name_(std::move(name)), rules_(rules) {}

void TextRows::split(std::string_view line) {
  if (rules_.comments) line = line.substr(0, line.find('#'));
  constexpr std::string_view spaces = " \t\f\v";
  for (std::size_t at = line.find_first_not_of(spaces); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(spaces, at), line.size());
    words_.push_back({line.substr(at, end - at), int(at) + 1});
    at = line.find_first_not_of(spaces, end);
  }
}

bool TextRows::next() {
  words_.clear();
  bool is_continued = false;
  while (at_ < text_.size()) {
    const std::size_t end = std::min(text_.find_first_of("\n\r", at_), text_.size());
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    if (end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n') ++at_;
    ++lines_;
    if (!is_continued) {
      raw_ = line;
      line_ = lines_;
    }
    split(line);
    is_continued = rules_.continued && !words_.empty() && words_.back().text == "\\";
    if (rules_.continued && !is_continued && !words_.empty() && line.ends_with('\\') &&
        words_.back().text.ends_with('\\')) {
      words_.back().text.remove_suffix(1);
      is_continued = true;
    } else if (is_continued) {
      words_.pop_back();
    }
    if (!is_continued && !words_.empty()) return true;
  }
  return !words_.empty();
}

void TextRows::refuse(int line, int column, const std::string& message) const {
  throw InputError({Problem{{name_, line, column}, message}});
}
void TextRows::refuse(const std::string& message) const { refuse(std::max(line_, 1), 0, message); }
void TextRows::refuse(const RowWord& word, const std::string& message) const { refuse(line_, word.column, message); }

double TextRows::number(const RowWord& word, std::string_view what) const {
  const auto value = number_of<double>(word.text);
  if (!value) refuse(word, fmt::format("'{}' is not {}{}", word.text.substr(0, 40), what, why_no_number(word.text)));
  return *value;
}

double TextRows::finite(const RowWord& word, std::string_view what) const {
  const double value = number(word, what);
  if (!std::isfinite(value)) refuse(word, fmt::format("{} is not finite: {}", what, word.text.substr(0, 40)));
  // Readers of surfaces hold floats.
  if (std::abs(value) > 3.4e38) refuse(word, fmt::format("{} is beyond 3.4e38: {}", what, word.text.substr(0, 40)));
  return value;
}

long long TextRows::integer(const RowWord& word, std::string_view what) const {
  const auto value = number_of<long long>(word.text);
  if (!value) refuse(word, fmt::format("'{}' is not {}: a whole number is wanted", word.text.substr(0, 40), what));
  return *value;
}

std::string plain_number(std::string_view word, double value) {
  const bool is_plain = word.find_first_not_of("0123456789+-.eE") == std::string_view::npos;
  // The reader takes the digits before the point for a whole number of 64 bits.
  const std::size_t digits = std::min(word.find_first_not_of("+-0123456789"), word.size());
  return is_plain && digits <= 18 && word.size() <= 60 && value != 0 ? std::string(word) : fmt::format("{:.9g}", value);
}

}  // namespace supple
