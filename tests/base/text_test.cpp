#include "base/text.h"

#include <gtest/gtest.h>

namespace supple {
namespace text_test {

TEST(Text, SizesAreInThousands) {
  EXPECT_EQ(bytes_text(0), "0 bytes");
  EXPECT_EQ(bytes_text(1), "1 byte");
  EXPECT_EQ(bytes_text(999), "999 bytes");
  EXPECT_EQ(bytes_text(1000), "1.0 kB");
  EXPECT_EQ(bytes_text(999949), "999.9 kB");
  EXPECT_EQ(bytes_text(999951), "1.0 MB");
  EXPECT_EQ(bytes_text(12'340'000'000), "12.3 GB");
}

TEST(Text, OneOfAThingIsSingular) {
  EXPECT_EQ(count_text(0, "repeat"), "0 repeats");
  EXPECT_EQ(count_text(1, "repeat"), "1 repeat");
}

TEST(Text, ControlCharactersAreSpeltOut) {
  EXPECT_EQ(printable("a b\tc\nd"), "a b\\x09c\\nd");
  EXPECT_EQ(printable("\033[2J\x7f"), "\\x1b[2J\\x7f");
  EXPECT_EQ(printable("\xc2\x9b[2J"), "\\x9b[2J");
  EXPECT_EQ(printable("gr\xc3\xbc\xc3\x9f \xc2\xb5"), "gr\xc3\xbc\xc3\x9f \xc2\xb5");
}

TEST(Text, BytesThatAreNotUtf8AreSpeltOut) {
  EXPECT_EQ(printable("t\xc3\xbcr\xff.png"), "t\xc3\xbcr\\xff.png");
  EXPECT_EQ(printable("\xe6\xbc"), "\\xe6\\xbc");  // a character that was cut off
  EXPECT_EQ(printable("\xe6\xbc\xa2\xf0\x9f\x90\xbf"), "\xe6\xbc\xa2\xf0\x9f\x90\xbf");
  EXPECT_EQ(first_character("\xe6\xbc\xa2!"), 3u);
  EXPECT_EQ(first_character("\xa2!"), 0u);
}

TEST(Text, WordsAreQuotedWhereAShellWouldSplitOrReplaceThem) {
  EXPECT_EQ(shell_word("body.soft.material.mu=2e4"), "body.soft.material.mu=2e4");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("my scene.toml"), "'my scene.toml'");
  EXPECT_EQ(shell_word("$it's"), "'$it'\\''s'");
}

}  // namespace text_test
}  // namespace supple
