// Describes small files that are odd in one way each, and what shall happen when they are read.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "base/error.h"
#include "base/types.h"

namespace supple::test {

struct OddFile {
  std::string what;  // is odd about it
  std::string ending;
  std::string bytes;
  std::string refusal;        // a part of the message, from its line on; empty: it is read
  std::string remark = "";    // a part of one of the remarks; empty: there are none
  Vec3 size = Vec3(1, 1, 1);  // of what is read
  double volume = 1;
};

inline const std::string mark = "\xef\xbb\xbf";  // of UTF-8, before the first character

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline std::string replaced_everywhere(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

inline std::string windows(const std::string& text) { return replaced_everywhere(text, "\n", "\r\n"); }
inline std::string old_mac(const std::string& text) { return replaced_everywhere(text, "\n", "\r"); }
inline std::string wide(const std::string& text) {
  std::string result = "\xff\xfe";
  for (const char c : text) result += {c, '\0'};
  return result;
}

// Reads the file and compares with what shall happen.
template <class Read>
void expect_as_said(const OddFile& odd, const Read& read) {
  SCOPED_TRACE(odd.ending + ", " + odd.what);
  const auto start = std::chrono::steady_clock::now();
  try {
    read();
    EXPECT_EQ(odd.refusal, "") << "was read";
  } catch (const InputError& error) {
    EXPECT_NE(odd.refusal, "") << error.what();
    EXPECT_NE(std::string(error.what()).find(odd.refusal), std::string::npos)
        << "found: '" << error.what() << "', expected: '" << odd.refusal << "'";
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

}  // namespace supple::test
