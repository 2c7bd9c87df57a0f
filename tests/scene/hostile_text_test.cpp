// Text that no scene would contain: it is refused with a place, and neither ends the program nor takes all its memory.
#include <gtest/gtest.h>

#include "scene/building/assemble.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"
#include "support/scene_text.h"

namespace supple {
namespace hostile_text_test {

std::string refusal_of(const std::string& text) {
  try {
    (void)Config::parse(text, "scene.toml", test::assets);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

TEST(HostileText, WhatOnlyAnAssertionOfTheParserNoticesIsAnErrorWithAPlace) {
  EXPECT_EQ(refusal_of("[="), "scene.toml:1:2: not TOML: a key or a value belongs here, not '='");
  EXPECT_EQ(refusal_of("g=[}"), "scene.toml:1:4: not TOML: a key or a value belongs here, not '}'");
  EXPECT_EQ(refusal_of("# \xc3\xa9\ntitle = \"\xc3\xa9\"\n \xc3\xa9 = 1\n[ = ]\n").substr(0, 13), "scene.toml:3:");
  EXPECT_EQ(refusal_of("title = \"\xc3\xa9\" # [=\na = [ \"\xc3\xa9\", } ]\n"),
            "scene.toml:2:12: not TOML: a key or a value belongs here, not '}'");
}

// Sanitizers see it, too: the parser's tables of characters call such letters unreachable.
TEST(HostileText, ALetterBeyondAsciiThatIsNoKeyIsAnErrorWithAPlace) {
  EXPECT_EQ(refusal_of("a\xc4\xbc = 1").substr(0, 25), "scene.toml:1:2: not TOML:");
  EXPECT_EQ(refusal_of("\xe2\x86\x92 = 1").substr(0, 25), "scene.toml:1:1: not TOML:");
}

TEST(HostileText, ASettingThatTripsAnAssertionIsTheWordThatItIs) {
  Config config =
      Config::parse("[[body]]\nname = \"a\"\nbox = { extent = [1, 1, 1], cells = [1, 1, 1] }\nmaterial = \"jelly\"\n",
                    "scene.toml", test::assets);
  config.set("body.a.density=[}", exclusive_keys());
  (void)read_scene(config);
  const std::vector<Problem> problems = config.take_problems();
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].text(), "--set body.a.density=[}: density = '[}': must be a number, above 0");
}

TEST(HostileText, KeysOfManyWordsAreRefusedBeforeTheyMakeTables) {
  const std::string many = repeated("a.", 200000) + "a";
  EXPECT_EQ(refusal_of(many + " = 1"), "scene.toml:1:64: not TOML: a key has more than 32 words");
  EXPECT_EQ(refusal_of("[" + many + "]"), "scene.toml:1:65: not TOML: a key has more than 32 words");
  EXPECT_EQ(refusal_of("x = { " + many + " = 1 }"), "scene.toml:1:70: not TOML: a key has more than 32 words");
  EXPECT_EQ(refusal_of(repeated("'a' . \"b\\\"\" . ", 100) + "a = 1").substr(0, 13), "scene.toml:1:");
  EXPECT_EQ(refusal_of("a = '" + repeated(".", 99) + "'\nb = \"\"\"" + repeated(".\n", 99) + "\"\"\"\n# " +
                       repeated(".", 99) + "\nc = [" + repeated("1.5, ", 99) + "]\n"),
            "");
  Config config = Config::parse("", "scene.toml", test::assets);
  EXPECT_THROW(config.set(many + "=1", exclusive_keys()), InputError);
}

TEST(HostileText, DeepListsAndTablesAreRefused) {
  EXPECT_NE(refusal_of("a = " + repeated("[", 300000)), "");
  EXPECT_NE(refusal_of("a = " + repeated("{ a = ", 100000)), "");
}

const std::string bar = R"([[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [2, 1, 1] }
)";

TEST(HostileText, NumbersWhosePowersLeaveTheRangeOfADoubleAreRefusedByTheirKeys) {
  EXPECT_EQ(test::problems_of(bar + "material = { model = \"polynomial\", mu = 1e300 }\n"),
            std::vector<std::string>{"scene.toml:4:41: mu = 1e+300: must be between -1e+30 and 1e+30"});
  EXPECT_EQ(test::problems_of("gravity = [0, -1e200, 0]\n" + bar + "material = \"jelly\"\n"),
            std::vector<std::string>{"scene.toml:1:11: gravity = [0, -1e+200, 0]: must be a list of three numbers, all "
                                     "between -1e+30 and 1e+30"});
}

TEST(HostileText, ABodySoFarAwayThatItsVerticesCoincideIsRefused) {
  const SceneDef scene = test::scene_of(bar + "material = \"jelly\"\nposition = [1e20, 0, 0]\n");
  try {
    (void)assemble(scene);
    FAIL() << "the scene was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("position of body 'bar': 1e+20 m from the origin"), std::string::npos)
        << error.what();
  }
}

}  // namespace hostile_text_test
}  // namespace supple
