// Tests colour on the terminal: which words are coloured, and when none are.
#include "base/console.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

namespace supple {
namespace console_test {

TEST(Console, MarksTheWordsThatTroubleBeginsWith) {
  EXPECT_EQ(highlighted("supple: no\n"), "\033[1;31msupple:\033[0m no\n");
  EXPECT_EQ(highlighted("a\nwarning: b\nwarning:"), "a\n\033[1mwarning:\033[0m b\n\033[1mwarning:\033[0m");
  EXPECT_EQ(highlighted("no supple: here\n\n"), "no supple: here\n\n");
  EXPECT_EQ(highlighted(""), "");
}

TEST(Console, ColoursTerminalsAloneAndOnlyThoseThatWantIt) {
  EXPECT_TRUE(may_colour(true, nullptr, "xterm"));
  EXPECT_TRUE(may_colour(true, "", "xterm"));
  EXPECT_FALSE(may_colour(false, nullptr, "xterm"));
  EXPECT_FALSE(may_colour(true, "1", "xterm"));
  EXPECT_FALSE(may_colour(true, nullptr, "dumb"));
  EXPECT_FALSE(may_colour(true, nullptr, nullptr));
}

// Returns what the other end of a terminal reads.
std::string seen_on_terminal(const char* text) {
  const int reading = posix_openpt(O_RDWR | O_NOCTTY);
  if (reading < 0 || grantpt(reading) != 0 || unlockpt(reading) != 0) return "no terminal";
  const int end = open(ptsname(reading), O_RDWR | O_NOCTTY);
  std::FILE* stream = fdopen(end, "w");
  if (stream == nullptr) return "no terminal";
  say(stream, text);
  std::fflush(stream);
  char buffer[200];
  const ssize_t count = read(reading, buffer, sizeof buffer);
  std::fclose(stream);
  close(reading);
  return {buffer, std::size_t(std::max<ssize_t>(0, count))};
}

TEST(Console, SaysItInColourOnATerminalAndPlainlyWithNoColor) {
  setenv("TERM", "xterm", 1);
  unsetenv("NO_COLOR");
  if (seen_on_terminal("x") == "no terminal") GTEST_SKIP() << "no pseudo-terminals here";
  EXPECT_EQ(seen_on_terminal("supple: x"), "\033[1;31msupple:\033[0m x");
  setenv("NO_COLOR", "1", 1);
  EXPECT_EQ(seen_on_terminal("supple: x"), "supple: x");
  unsetenv("NO_COLOR");
}

}  // namespace console_test
}  // namespace supple
