// The two ways in which something can be wrong: input from outside (InputError: places and what is allowed) and a
// mistake of ours (SUPPLE_CHECK: both values). A numerical failure is neither; it is returned in a step's report.
#pragma once

#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace supple {

// One thing that is wrong with an input. Lines and columns count from 1; 0 means "the file as a whole".
struct Problem {
  std::string source;  // file name, or the command-line option that set the value
  int line = 0;
  int column = 0;
  std::string message;  // what is wrong and what is allowed

  std::string text() const;
};

// Input that cannot be used. Holds every problem that was found, not only the first; exit status 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Problem> problems);
  InputError(std::string source, std::string message)
      : InputError({Problem{std::move(source), 0, 0, std::move(message)}}) {}
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

// A run that cannot go on (a full disk, a lost renderer, numbers that left the finite range); exit status 1.
class RunError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] void check_failed(const char* file, int line, std::string_view text, const std::string& left,
                               const std::string& right);

}  // namespace supple

// States what must hold between two values; prints both when it does not. For mistakes of ours, never for input.
#define SUPPLE_CHECK(left, op, right)                                                                     \
  do {                                                                                                    \
    const auto& check_left = (left);                                                                      \
    const auto& check_right = (right);                                                                    \
    if (!(check_left op check_right))                                                                     \
      ::supple::check_failed(__FILE__, __LINE__, #left " " #op " " #right, fmt::format("{}", check_left), \
                             fmt::format("{}", check_right));                                             \
  } while (false)
