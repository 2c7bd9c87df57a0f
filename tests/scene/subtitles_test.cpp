// Tests subtitles: those that a scene lists, those of .srt files, and which of them a picture shows.
#include <gtest/gtest.h>

#include <fstream>

#include "film/pictures/picture_words.h"
#include "scene/reading/scene_reader.h"
#include "scene/reading/srt_file.h"
#include "support/bodies.h"

namespace supple {
namespace subtitles_test {

const std::string bar = R"([[body]]
box = { extent = [1, 1, 1], cells = [1, 1, 1] }
material = "jelly"
)";

SceneDef scene_of(const std::string& text, const std::filesystem::path& folder = ".") {
  Config config = Config::parse_beside(bar + text, folder / "scene.toml", test::assets);
  SceneDef scene = read_scene(config);
  config.finish();
  return scene;
}

std::string refusal_of(const std::string& text, const std::filesystem::path& folder = ".") {
  try {
    (void)scene_of(text, folder);
  } catch (const InputError& error) {
    return error.problems().size() == 1 ? error.problems().front().text() : error.what();
  }
  return "";
}

std::string srt_refusal(const std::string& text) {
  try {
    (void)read_srt(text, "a.srt");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Subtitles, AreShownFromOneTimeToAnother) {
  const SceneDef scene = scene_of(R"([text]
subtitles = [{ from = 1, to = 2, text = "second" }, { from = 0, to = 1.5, text = "first" }]
)");
  EXPECT_EQ(subtitle_text(scene.text, 0.0), "");
  EXPECT_EQ(subtitle_text(scene.text, 1 / 30.0), "first") << "the first picture, which a player shows from 0 on";
  EXPECT_EQ(subtitle_text(scene.text, 1.0), "first");
  EXPECT_EQ(subtitle_text(scene.text, 31 / 30.0), "first\nsecond");
  EXPECT_EQ(subtitle_text(scene.text, 2.0), "second");
  EXPECT_EQ(subtitle_text(scene.text, 61 / 30.0), "");
  EXPECT_EQ(all_subtitles(scene.text).size(), 3u);
}

// A subtitle is in as many pictures as its time has, the first of which a player shows when it begins.
TEST(Subtitles, LastAsManyPicturesAsTheirTime) {
  SceneDef scene = scene_of("[text]\nsubtitles = [{ from = 1.001, to = 2.002, text = \"x\" }]\n");
  scene.fps = *FrameRate::parse("30000/1001");
  std::vector<int> shown;
  for (int frame = 0; frame < 90; ++frame)
    if (!subtitle_text(scene.text, scene.time_after(frame)).empty()) shown.push_back(frame);
  ASSERT_EQ(shown.size(), 30u);
  EXPECT_EQ(shown.front(), 30);
}

TEST(Subtitles, AreReadFromSrtFiles) {
  const std::vector<Subtitle> list = read_srt(
      "1\r\n00:00:00,000 --> 00:00:01,500\r\nOne\r\ntwo lines\r\n\r\n\r\n2\r\n01:02:03,004 --> 01:02:04,000\r\n"
      "Gr\xc3\xbc\xc3\x9f"
      "e\r\n",
      "a.srt");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].from, 0);
  EXPECT_EQ(list[0].to, 1.5);
  EXPECT_EQ(list[0].text, "One\ntwo lines");
  EXPECT_EQ(list[1].from, 3723.004);
  EXPECT_EQ(list[1].text,
            "Gr\xc3\xbc\xc3\x9f"
            "e");
  EXPECT_EQ(list[1].place.line, 9);
  EXPECT_TRUE(read_srt("", "a.srt").empty());
}

TEST(Subtitles, OfSrtFilesAreRefusedAtTheirLine) {
  EXPECT_EQ(srt_refusal("Hello\n"),
            "a.srt:1:1: 'Hello' should be the number of a subtitle, in a line of its own after a blank one");
  EXPECT_EQ(srt_refusal("1\n00:00:00.000 --> 00:00:01,000\nx\n"),
            "a.srt:2:1: '00:00:00.000 --> 00:00:01,000' should be the times of a subtitle, as "
            "00:00:01,500 --> 00:00:04,000");
  EXPECT_EQ(srt_refusal("1\n00:00:02,000 --> 00:00:01,000\nx\n"), "a.srt:2:1: a subtitle must end after it begins");
  EXPECT_EQ(srt_refusal("1\n00:00:02,000 --> 00:00:03,000\nx\n\n2\n00:00:01,000 --> 00:00:03,000\nx\n"),
            "a.srt:6:1: begins before the subtitle above it");
  EXPECT_EQ(srt_refusal("1\n00:00:00,000 --> 00:00:01,000\n\n"), "a.srt:3:1: a subtitle without text");
  EXPECT_EQ(srt_refusal("1\n"), "a.srt:1:1: the times of the last subtitle are missing");
  EXPECT_EQ(srt_refusal("1\n00:00:00,000 --> 00:00:01,000\n<i>x</i>\n"),
            "a.srt:3:1: has the mark of style '<i>', which pictures do not show");
  EXPECT_EQ(srt_refusal("1\n00:00:00,000 --> 00:00:01,000\na\tb\n"), "a.srt:3:1: has the control character \\x09");
  EXPECT_EQ(srt_refusal("1\n00:00:00,000 --> 00:00:01,000\n\xff\n"), "a.srt:3:1: is not UTF-8");
  for (const char* times :
       {"00:60:00,000 --> 00:61:00,000", "0:00:00,000 --> 00:00:01,000", "-->", "00:00:00,000 --> 00:00:01,000 X1:1"})
    EXPECT_NE(srt_refusal(std::string("1\n") + times + "\nx\n"), "") << times;
}

TEST(Subtitles, OfASceneAndItsFileComeInOneOrder) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "words.srt") << "\xef\xbb\xbf"
                                              "1\n00:00:01,000 --> 00:00:02,000\nfrom the file\n";
  const SceneDef scene = scene_of(R"([text]
subtitle_file = "words.srt"
subtitles = [{ from = 3, to = 4, text = "last" }, { from = 0, to = 0.5, text = "first" }]
)",
                                  folder.path);
  ASSERT_EQ(scene.text.subtitles.size(), 3u);
  EXPECT_EQ(scene.text.subtitles[1].text, "from the file");
  EXPECT_TRUE(scene.text.subtitle_file);

  std::ofstream(folder.path / "words.srt") << "1\n00:00:01,000 --> 00:00:02,000\n";
  EXPECT_EQ(refusal_of("[text]\nsubtitle_file = \"words.srt\"\n", folder.path),
            (folder.path / "words.srt").string() + ":2:1: a subtitle without text");
}

TEST(Subtitles, OfASceneAreRefusedAtTheirPlace) {
  const auto with = [](const std::string& row) { return refusal_of("[text]\nsubtitles = [{ " + row + " }]\n"); };
  EXPECT_EQ(with("from = 1, to = 1, text = \"x\""), "./scene.toml:5:31: to = 1: must be after it begins, at 1");
  EXPECT_EQ(with("from = 1, to = 2, text = \" \""), "./scene.toml:5:41: text: must not be empty");
  EXPECT_EQ(with("from = 1, to = 2, text = \"a\\tb\""), "./scene.toml:5:41: text: has the control character \\x09");
  EXPECT_NE(with("from = -1, to = 2, text = \"x\"").find("scene.toml:5:"), std::string::npos);
  EXPECT_NE(with("from = 1, text = \"x\"").find("to"), std::string::npos);
  EXPECT_EQ(with("from = 1, to = 2, text = \"a\\nb\""), "");
}

TEST(Rates, OfScenesAreNumbersOrFractions) {
  EXPECT_EQ(scene_of("").fps.text(), "30");
  const auto rate_of = [](const std::string& fps) {
    Config config = Config::parse("fps = " + fps + "\n" + bar, "scene.toml", test::assets);
    const SceneDef scene = read_scene(config);
    config.finish();
    return scene.fps.text();
  };
  EXPECT_EQ(rate_of("24"), "24");
  EXPECT_EQ(rate_of("23.976"), "24000/1001");
  EXPECT_EQ(rate_of("\"30000/1001\""), "30000/1001");
  for (const char* wrong : {"\"30/0\"", "\"fast\"", "0.5", "\"1/2\"", "true", "\"200000/1\""})
    EXPECT_THROW((void)rate_of(wrong), InputError) << wrong;
  SceneDef scene;
  scene.fps = *FrameRate::parse("30000/1001");
  EXPECT_DOUBLE_EQ(scene.time_step(), 1001 / 30000.0);
}

}  // namespace subtitles_test
}  // namespace supple
