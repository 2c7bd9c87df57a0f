// Tests words in any script: which font draws what, how letters join and in which direction they run, and how lines of
// subtitles are broken.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "render/code_points.h"
#include "render/font_search.h"
#include "render/subtitles.h"
#include "render/text_bitmap.h"

namespace supple {
namespace scripts_test {

const Font lato = {"/usr/share/fonts/truetype/lato/Lato-Regular.ttf", 0};
const std::string arabic = "\xd8\xb3\xd9\x84\xd8\xa7\xd9\x85";  // salam
const std::string alef = "\xd7\x90", bet = "\xd7\x91";          // Hebrew
const std::string han = "\xe6\xbc\xa2", ji = "\xe5\xad\x97";    // ideographs
const std::string nobodys = "\xf4\x8f\xbf\xbd";                 // for private use: no font has it

class Scripts : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(lato.file)) GTEST_SKIP() << lato.file << " is not installed";
    if (!searches_fonts()) GTEST_SKIP() << "the program was built without fontconfig and raqm";
  }
};

int darkness(const TextBitmap& bitmap) { return std::accumulate(bitmap.coverage.begin(), bitmap.coverage.end(), 0); }

// Returns the columns of a bitmap from one to before another, row after row.
std::vector<std::uint8_t> columns(const TextBitmap& bitmap, int from, int to) {
  std::vector<std::uint8_t> part;
  for (int row = 0; row < bitmap.height; ++row)
    for (int column = from; column < to; ++column)
      part.push_back(bitmap.coverage[std::size_t(row) * bitmap.width + column]);
  return part;
}

TEST_F(Scripts, LettersOfTheFontAreDrawnByItAlone) {
  for (const char* text : {"Squirrel, 40 kPa",
                           "Gr\xc3\xbc\xc3\x9f"
                           "e",
                           "\xce\xb1\xce\xb2\xce\xb3"})
    for (const char32_t point : code_points(text)) EXPECT_TRUE(stands_alone(point)) << text;
  EXPECT_TRUE(characters_without_glyph(lato,
                                       "Gr\xc3\xbc\xc3\x9f"
                                       "e")
                  .empty());
  // Without kerning, a text is as wide as its letters.
  const auto width = [](const std::string& text) { return draw_text(lato, text, 32).width - 2; };
  EXPECT_EQ(width("AVATAR"), 3 * width("A") + width("V") + width("T") + width("R"));
}

TEST_F(Scripts, CharactersThatTheFontLacksComeFromOthers) {
  if (!font_with(U'\u6f22')) GTEST_SKIP() << "no font with ideographs is installed";
  EXPECT_TRUE(characters_without_glyph(lato, "A " + han).empty());
  const TextBitmap box = draw_text(lato, nobodys, 32), one = draw_text(lato, han, 32), other = draw_text(lato, ji, 32);
  EXPECT_NE(one.coverage, box.coverage);
  EXPECT_NE(one.coverage, other.coverage);
  EXPECT_GT(darkness(one), 1000);
  EXPECT_EQ(one.height, draw_text(lato, "X", 32).height) << "a line is as high as those of its font";
}

TEST_F(Scripts, WhatNoFontHasIsNamedOnce) {
  EXPECT_EQ(characters_without_glyph(lato, "a" + nobodys + "b" + nobodys), std::vector<std::string>{nobodys});
  EXPECT_TRUE(characters_without_glyph(lato,
                                       "a\xe2\x80\x8d"
                                       "b\nc")
                  .empty())
      << "a joiner and a new line show nothing";
}

TEST_F(Scripts, LettersRunInTheDirectionOfTheirScript) {
  if (!font_with(U'\u05d0')) GTEST_SKIP() << "no font with Hebrew is installed";
  const TextBitmap word = draw_text(lato, alef + bet, 40), last = draw_text(lato, bet, 40);
  EXPECT_EQ(columns(word, 0, last.width - 2), columns(last, 0, last.width - 2))
      << "the second letter is not at the left";
}

TEST_F(Scripts, LettersJoin) {
  if (!font_with(U'\u0633')) GTEST_SKIP() << "no font with Arabic is installed";
  int apart = 0;
  for (const char32_t point : code_points(arabic)) apart += draw_text(lato, in_utf8(point), 40).width - 2;
  EXPECT_LT(draw_text(lato, arabic, 40).width - 2, 0.9 * apart);
}

TEST_F(Scripts, LettersOfOtherFontsStayWithinTheLine) {
  const std::string stacked = "\xe0\xb8\x99\xe0\xb9\x89\xe0\xb8\xb3" + han + arabic;
  for (const int em : {9, 22, 40, 90}) {
    const TextBitmap bitmap = draw_text(lato, stacked, em);
    EXPECT_EQ(bitmap.height, draw_text(lato, "X", em).height);
    EXPECT_EQ(std::ranges::count_if(columns(bitmap, 0, bitmap.width), [](int c) { return c > 0; }) > 0, true);
  }
}

TEST_F(Scripts, FamiliesAreFoundByTheirNames) {
  const std::vector<std::string> families = font_families();
  ASSERT_TRUE(std::ranges::find(families, "Lato") != families.end());
  const auto found = font_of_family("lato");
  ASSERT_TRUE(found);
  EXPECT_EQ(std::filesystem::path(found->file).filename(), "Lato-Regular.ttf");
  EXPECT_FALSE(font_of_family("No Such Family"));
}

TEST_F(Scripts, LinesAreBrokenAtSpacesIntoEqualParts) {
  const std::string text = "The quick brown fox jumps over the lazy dog";
  const auto reach = [](const std::string& line) { return draw_text(lato, line, 20).width - 2; };
  const int width = reach(text) * 6 / 10;
  const std::vector<std::string> lines = wrapped(lato, text, 20, width);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0] + " " + lines[1], text);
  for (const std::string& line : lines) EXPECT_LE(reach(line), width) << line;
  EXPECT_LT(std::abs(reach(lines[0]) - reach(lines[1])), reach("quick brown")) << lines[0];
  EXPECT_EQ(wrapped(lato, "a\nb", 20, 100), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(wrapped(lato, text, 20, reach(text)), std::vector<std::string>{text});
}

TEST_F(Scripts, AWordThatIsWiderThanALineIsBroken) {
  const std::string word(60, 'm');
  const std::vector<std::string> lines = wrapped(lato, "a " + word, 20, 300);
  EXPECT_GT(lines.size(), 2u);
  std::string together;
  for (const std::string& line : lines) {
    EXPECT_LE(draw_text(lato, line, 20).width, 302);
    together += line;
  }
  EXPECT_EQ(std::ranges::count(together, 'm'), 60);
}

TEST_F(Scripts, IdeographsAreBrokenAnywhereButBeforeAStop) {
  if (!font_with(U'\u6f22')) GTEST_SKIP() << "no font with ideographs is installed";
  std::string text;
  for (int i = 0; i < 9; ++i) text += i % 2 == 0 ? han : ji;
  const std::string stop = "\xe3\x80\x82";
  const int wide = draw_text(lato, text, 20).width - 2;
  const std::vector<std::string> lines = wrapped(lato, text + stop, 20, wide + 2);
  ASSERT_EQ(lines.size(), 2u);
  for (const std::string& line : lines) EXPECT_FALSE(line.starts_with(stop)) << line;
}

// Lines that are shown on any picture are as far from its borders as every screen shows, and readable.
TEST_F(Scripts, SubtitlesStandInTheSafePartOfThePicture) {
  for (const auto& [width, height] : {std::pair{640, 360}, {1920, 1080}, {360, 640}, {1080, 1920}}) {
    for (const int grey : {0, 128, 255}) {
      Stage stage;
      stage.width = width;
      stage.height = height;
      stage.font = lato;
      const std::string text = "A line that is long enough to be broken on a picture that is taller than it is wide";
      stage.subtitles = {"short", text};
      Subtitles subtitles(stage);
      const PixelRect room = subtitles.room();
      EXPECT_GE(room.x, width / 20 - 1);
      EXPECT_LE(room.right(), width - width / 20 + 1);
      EXPECT_LE(room.bottom(), height - height / 20 + 1);
      EXPECT_GT(room.y, height / 2);
      Image image{width, height, std::vector<std::uint8_t>(std::size_t(width) * height * 3, std::uint8_t(grey))};
      const Image before = image;
      EXPECT_EQ(subtitles.show("").width, 0);
      const PixelRect place = subtitles.show(text);
      EXPECT_EQ(place.bottom(), room.bottom());
      subtitles.draw(image);
      int darkest = 255, lightest = 0;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const std::size_t pixel = 3 * (std::size_t(y) * width + x);
          const bool inside = x >= room.x && x < room.right() && y >= room.y && y < room.bottom();
          if (!inside) {
            ASSERT_EQ(image.rgb[pixel], before.rgb[pixel]) << "outside its room";
          } else if (image.rgb[pixel] != before.rgb[pixel]) {
            darkest = std::min<int>(darkest, image.rgb[pixel]);
            lightest = std::max<int>(lightest, image.rgb[pixel]);
          }
        }
      }
      EXPECT_GT(lightest, 235);
      EXPECT_LT(darkest, 90) << "the plate is too light on grey " << grey;
    }
  }
}

}  // namespace scripts_test
}  // namespace supple
