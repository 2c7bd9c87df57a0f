// Two things can be wrong: the input from outside (InputError names the places and what is allowed), or our own code
// (SUPPLE_CHECK prints both values). A numerical failure is neither; it is returned in a step's report.
#pragma once

#include <fmt/core.h>

#include <compare>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace supple {

// Names a place in an input. Lines and columns count from 1; 0 means "the file as a whole".
struct FilePlace {
  std::string source;  // file name, or the command-line option that set the value
  int line = 0;
  int column = 0;

  std::string text() const;  // source:line:column

  auto operator<=>(const FilePlace&) const = default;
};

// Describes one thing that is wrong with an input.
struct Problem {
  FilePlace place;
  std::string message;  // what is wrong and what is allowed

  std::string text() const;
};

// Reports input that cannot be used. It holds every problem that was found, not only the first; the exit status is 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Problem> problems);
  InputError(std::string source, std::string message)
      : InputError({Problem{{std::move(source)}, std::move(message)}}) {}
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

// Reports a run that cannot continue (a full disk, a lost renderer, numbers that are no longer finite); the exit status
// is 1.
class RunError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] void check_failed(const char* file, int line, std::string_view text, const std::string& left,
                               const std::string& right);

}  // namespace supple

// States what must hold between two values and prints both when it does not. It is meant for mistakes of ours, never
// for input.
#define SUPPLE_CHECK(left, op, right)                                                                     \
  do {                                                                                                    \
    const auto& check_left = (left);                                                                      \
    const auto& check_right = (right);                                                                    \
    if (!(check_left op check_right))                                                                     \
      ::supple::check_failed(__FILE__, __LINE__, #left " " #op " " #right, fmt::format("{}", check_left), \
                             fmt::format("{}", check_right));                                             \
  } while (false)
