#include "base/error.h"

#include <fmt/ranges.h>

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

std::string Problem::text() const {
  if (line <= 0) return source.empty() ? message : fmt::format("{}: {}", source, message);
  if (column <= 0) return fmt::format("{}:{}: {}", source, line, message);
  return fmt::format("{}:{}:{}: {}", source, line, column, message);
}

InputError::InputError(std::vector<Problem> problems)
    : std::runtime_error(joined(problems)), problems_(std::move(problems)) {}

void check_failed(const char* file, int line, std::string_view text, const std::string& left,
                  const std::string& right) {
  throw std::logic_error(fmt::format("{}:{}: check failed: {} ({} against {})", file, line, text, left, right));
}

}  // namespace supple
