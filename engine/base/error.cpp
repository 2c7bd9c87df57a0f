#include "base/error.h"

#include <fmt/ranges.h>

#include <sstream>

#include "base/text.h"

namespace supple {
namespace {

std::string joined(const std::vector<Problem>& problems) {
  std::string all;
  for (const Problem& problem : problems) {
    if (!all.empty()) all += '\n';
    all += problem.text();
  }
  return all;
}

}  // namespace

std::string FilePlace::text() const {
  std::string all = source;
  if (line > 0) all += fmt::format(":{}", line);
  if (line > 0 && column > 0) all += fmt::format(":{}", column);
  return all;
}

std::string Problem::text() const {
  const std::string where = place.text();
  std::string shown;
  std::istringstream lines(where.empty() ? message : where + ": " + message);
  for (std::string words; std::getline(lines, words);) shown += (shown.empty() ? "" : "\n") + printable(words);
  return shown;
}

InputError::InputError(std::vector<Problem> problems)
    : std::runtime_error(joined(problems)), problems_(std::move(problems)) {}

void check_failed(const char* file, int line, std::string_view text, const std::string& left,
                  const std::string& right) {
  throw std::logic_error(fmt::format("{}:{}: check failed: {} ({} against {})", file, line, text, left, right));
}

}  // namespace supple
