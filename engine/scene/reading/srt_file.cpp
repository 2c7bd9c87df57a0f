#include "scene/reading/srt_file.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "base/text.h"

namespace supple {
namespace {

// Goes through the lines of a file. Lines end with \n or \r\n.
class SrtLines {
 public:
  SrtLines(std::string_view text, const std::string& name) : rest_(text), name_(name) {}

  // Goes to the next line. Returns false at the end.
  bool next() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_ = end == rest_.npos ? std::string_view() : rest_.substr(end + 1);
    if (line_.ends_with('\r')) line_.remove_suffix(1);
    ++number_;
    return true;
  }
  std::string_view line() const { return line_; }
  bool is_blank() const { return line_.find_first_not_of(" \t") == line_.npos; }
  FilePlace place() const { return {name_, number_, 1}; }
  [[noreturn]] void refuse(const std::string& message) const { throw InputError({Problem{place(), message}}); }

 private:
  std::string_view rest_, line_;
  std::string name_;
  int number_ = 0;
};

bool is_number(std::string_view text) {
  return !text.empty() && text.size() <= 9 && text.find_first_not_of("0123456789") == text.npos;
}

// Reads "00:01:02,345" [s]; nothing where the text is not of this form.
std::optional<double> time_of(std::string_view text) {
  constexpr std::string_view form = "00:00:00,000";
  if (text.size() != form.size()) return std::nullopt;
  std::array<int, 4> parts{};
  for (std::size_t i = 0, part = 0; i < form.size(); ++i) {
    if (form[i] != '0') {
      if (text[i] != form[i]) return std::nullopt;
      ++part;
    } else {
      if (text[i] < '0' || text[i] > '9') return std::nullopt;
      parts[part] = 10 * parts[part] + (text[i] - '0');
    }
  }
  if (parts[1] > 59 || parts[2] > 59) return std::nullopt;
  return (1000LL * (3600LL * parts[0] + 60 * parts[1] + parts[2]) + parts[3]) / 1000.0;
}

Subtitle timed(const SrtLines& lines) {
  constexpr std::string_view arrow = " --> ";
  std::string_view line = lines.line();
  while (line.ends_with(' ')) line.remove_suffix(1);
  const std::size_t at = line.find(arrow);
  const auto from = time_of(line.substr(0, at));
  const auto to = at == line.npos ? std::nullopt : time_of(line.substr(at + arrow.size()));
  if (!from || !to)
    lines.refuse(fmt::format("'{}' should be the times of a subtitle, as 00:00:01,500 --> 00:00:04,000",
                             printable(lines.line())));
  if (*from >= *to) lines.refuse("a subtitle must end after it begins");
  return {*from, *to, "", {}};
}

}  // namespace

std::string subtitle_fault(std::string_view line) {
  for (std::string_view rest = line; !rest.empty();) {
    const std::size_t length = first_character(rest);
    if (length == 0) return "is not UTF-8";
    const auto byte = static_cast<unsigned char>(rest[0]);
    if (byte < 0x20 || byte == 0x7f) return fmt::format("has the control character {}", printable(rest.substr(0, 1)));
    rest.remove_prefix(length);
  }
  constexpr std::array marks = {"<i>", "</i>", "<b>", "</b>", "<u>", "</u>", "<font", "</font>", "{\\"};
  for (const std::string_view mark : marks)
    if (lowercase(line).find(mark) != std::string::npos)
      return fmt::format("has the mark of style '{}', which pictures do not show", mark);
  return "";
}

std::vector<Subtitle> read_srt(std::string_view text, const std::string& name) {
  std::vector<Subtitle> list;
  SrtLines lines(text, name);
  while (lines.next()) {
    if (lines.is_blank()) continue;
    if (!is_number(lines.line()))
      lines.refuse(fmt::format("'{}' should be the number of a subtitle, in a line of its own after a blank one",
                               printable(lines.line())));
    if (!lines.next()) lines.refuse("the times of the last subtitle are missing");
    Subtitle subtitle = timed(lines);
    if (!list.empty() && subtitle.from < list.back().from) lines.refuse("begins before the subtitle above it");
    while (lines.next() && !lines.is_blank()) {
      if (const std::string fault = subtitle_fault(lines.line()); !fault.empty()) lines.refuse(fault);
      if (subtitle.text.empty()) subtitle.place = lines.place();
      subtitle.text += (subtitle.text.empty() ? "" : "\n") + std::string(lines.line());
    }
    if (subtitle.text.empty()) lines.refuse("a subtitle without text");
    list.push_back(std::move(subtitle));
  }
  return list;
}

}  // namespace supple
