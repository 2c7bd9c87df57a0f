// Tests what the warning about unsolved steps says of a film's scene.
#include "film/record/unsolved_words.h"

#include <gtest/gtest.h>

#include <map>

#include "support/places.h"

namespace supple {
namespace unsolved_words_test {

UnsolvedWords words_of(const std::string& text) {
  return unsolved_words(Script::load(SceneSource("scene.toml", text), test::assets, {}));
}

std::string cube(const std::string& name, const std::string& keys = "") {
  return "[[body]]\nname = \"" + name +
         "\"\nbox = { extent = [0.1, 0.1, 0.1], cells = [1, 1, 1] }\nmaterial = \"jelly\"\n" + keys;
}

using Options = std::map<std::string, std::string>;

TEST(UnsolvedWords, NameTheOptionsThatTripleTheIterations) {
  EXPECT_EQ(words_of(cube("a")).options, (Options{{"a", "--set solver.iterations=30"}}));
  EXPECT_EQ(words_of("solver.iterations = 4\n" + cube("a")).options, (Options{{"a", "--set solver.iterations=12"}}));
  EXPECT_EQ(words_of(cube("a") + cube("b", "solver = { iterations = 20 }\n")).options,
            (Options{{"a", "--set solver.iterations=30"}, {"b", "--set body.b.solver.iterations=60"}}));
}

TEST(UnsolvedWords, NameTheTableOfBodiesThatAreCopies) {
  const std::string copies =
      "[[scatter]]\nbodies = [\"a\", \"b\"]\ncount = 6\nbox = [[0, 0, 0], [1, 1, 1]]\nseed = 3\n";
  const UnsolvedWords words = words_of(cube("a") + cube("b", "solver = { iterations = 7 }\n") + copies);
  EXPECT_EQ(words.options.size(), 6u);
  for (const auto& [body, option] : words.options) {
    EXPECT_EQ(option, body.starts_with("a") ? "--set solver.iterations=30" : "--set body.b.solver.iterations=21")
        << body;
  }
}

TEST(UnsolvedWords, LeaveOutBodiesOfWhichItIsMeant) {
  EXPECT_EQ(words_of(cube("a", "meant = [\"unsolved\"]\n") + cube("b")).meant, std::vector<std::string>{"a"});
}

}  // namespace unsolved_words_test
}  // namespace supple
