// Tests how the program behaves towards its user: help with examples, completion, what it reports about the machine,
// colour.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "output/files/child_program.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace manners_test {

using test::Result;
using test::run;

using Words = std::set<std::string>;

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Runs the program in a folder of its own.
struct Program {
  test::TemporaryFolder folder;

  std::string help(const std::vector<std::string>& verb) const {
    std::vector<std::string> words = verb;
    words.push_back("--help");
    const Result result = run(folder.path, words);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  }
  // Returns the verbs that the help lists.
  std::vector<std::string> verbs() const {
    const std::string text = help({});
    std::vector<std::string> names;
    const std::regex pattern("^  (\\w+) +\\S.*");
    std::smatch match;
    for (const std::string& line : lines_of(text.substr(text.find("Subcommands:")))) {
      if (std::regex_match(line, match, pattern)) names.push_back(match[1]);
    }
    return names;
  }
  Words completed(const std::vector<std::string>& line) const {
    std::vector<std::string> words = {"complete", "--"};
    words.insert(words.end(), line.begin(), line.end());
    const Result result = run(folder.path, words);
    EXPECT_EQ(result.status, 0) << result.err;
    const std::vector<std::string> answer = lines_of(result.out);
    return {answer.begin(), answer.end()};
  }
};

TEST(Help, OfEveryVerbHasAnExampleOfIt) {
  const Program program;
  const std::vector<std::string> verbs = program.verbs();
  for (const char* known : {"render", "replay", "check", "mesh", "info", "compare", "bench", "list", "doctor"})
    EXPECT_NE(std::ranges::find(verbs, known), verbs.end()) << known;
  EXPECT_NE(program.help({}).find("Examples: supple render "), std::string::npos);
  for (const std::string& verb : verbs) {
    const std::string text = program.help({verb});
    EXPECT_TRUE(std::regex_search(text, std::regex("Examples?: supple " + verb + "\\b"))) << text;
  }
}

// Examples are there to be typed: a word without an ending, after the verb, is a scene or a replay that ships.
TEST(Help, HasExamplesOfWhatShips) {
  const Program program;
  const std::string shipped = "\n" + run(program.folder.path, {"list"}).out;
  const std::regex example(R"((?:^|\n)(?:Examples?:)? +supple [a-z]+ ([a-z][a-z-]*)(?= |\n))");
  int examples = 0;
  for (const char* verb : {"render", "replay", "sweep", "profile", "info"}) {
    const std::string text = program.help({verb});
    for (std::sregex_iterator found(text.begin(), text.end(), example), end; found != end; ++found) {
      EXPECT_NE(shipped.find("\n" + (*found)[1].str() + " "), std::string::npos) << found->str();
      ++examples;
    }
  }
  EXPECT_GE(examples, 6);
}

TEST(Help, NamesTheWordThatIsNoVerbAndTheNearestOne) {
  const Program program;
  const auto told = [&](const std::string& word) {
    const Result result = run(program.folder.path, {word, "squirrel"});
    EXPECT_EQ(result.status, 2) << word;
    return result.err;
  };
  EXPECT_EQ(told("rendr"), "supple: no verb 'rendr'; did you mean 'render'?\nTry: supple --help\n");
  EXPECT_EQ(told("version"), "supple: no verb 'version'; did you mean '--version'?\nTry: supple --help\n");
  EXPECT_EQ(told("frobnicating"), "supple: no verb 'frobnicating'\nTry: supple --help\n");
  EXPECT_EQ(told("--frobnicating"), "supple: no option '--frobnicating'\nTry: supple --help\n");
}

TEST(Words, ThatAreMistypedAreMetByTheNearestThatIsKnown) {
  const Program program;
  const auto told = [&](std::vector<std::string> words) {
    const Result result = run(program.folder.path, words);
    EXPECT_EQ(result.status, 2) << words[1];
    return result.err;
  };
  for (const char* verb : {"render", "check", "info", "profile"})
    EXPECT_EQ(told({verb, "squirel"}), "squirel: no such file; did you mean 'squirrel'?\n") << verb;
  EXPECT_EQ(told({"replay", "eer-pull"}), "eer-pull: no such file; did you mean 'ear-pull'?\n");
  EXPECT_EQ(told({"sweep", "pulled-ba"}), "pulled-ba: no such file; did you mean 'pulled-bar'?\n");
  EXPECT_EQ(told({"mesh", "squirel", "-o", "s.mesh"}), "squirel: no such file; did you mean 'squirrel'?\n");
  std::filesystem::create_directories(program.folder.path / "mine");
  std::ofstream(program.folder.path / "mine" / "balloon.toml") << "frames = 1\n";
  EXPECT_EQ(told({"render", "mine/ballon.toml"}),
            "mine/ballon.toml: no such file; did you mean 'mine/balloon.toml'?\n");
  EXPECT_EQ(told({"render", "nothing-like-it.toml"}), "nothing-like-it.toml: no such file\n");
  std::filesystem::create_directories(program.folder.path / "out" / "squirrel");
  std::ofstream(program.folder.path / "out" / "squirrel" / "run.json") << "{}\n";
  for (const char* verb : {"draw", "page"})
    EXPECT_EQ(told({verb, "out/squirel/"}), "out/squirel/: no such folder; did you mean 'out/squirrel'?\n") << verb;
  EXPECT_EQ(
      told({"check", "squirrel", "--set", "body.sof.material.mu=3"}),
      "--set body.sof.material.mu=3: there is no body named 'sof' (there is soft, stiff or polynomial); did you mean "
      "'soft'?\n");
  EXPECT_EQ(told({"bench", "figur7"}).find("supple: NAME: 'figur7': must be all, table1, "), 0u);
  EXPECT_NE(told({"bench", "figur7"}).find("; did you mean 'figure7'?\n"), std::string::npos);
  EXPECT_NE(told({"render", "squirrel", "--format", "giff"}).find("; did you mean 'gif'?\n"), std::string::npos);
}

TEST(Check, TellsAFilmMakerInWordsAndInNumbersWhereTheyAreAsked) {
  const Program program;
  std::ofstream(program.folder.path / "s.toml") << "[[body]]\nname = \"ball\"\nshape = \"shapes/sphere.toml\"\n"
                                                   "vertices = 300\nsize = 0.4\nmaterial = \"jelly\"\n";
  const Result words = run(program.folder.path, {"check", "s.toml"});
  EXPECT_EQ(words.status, 0) << words.err;
  EXPECT_NE(words.out.find(" for its time step\n    skin: close to its elements\n"), std::string::npos) << words.out;
  EXPECT_EQ(words.out.find('%'), std::string::npos);
  EXPECT_EQ(words.out.find("rho"), std::string::npos);
  const Result numbers = run(program.folder.path, {"check", "s.toml", "--verbose"});
  EXPECT_NE(numbers.out.find("(k h^2 / (rho L^2) = "), std::string::npos) << numbers.out;
  EXPECT_NE(numbers.out.find("% outside the elements"), std::string::npos) << numbers.out;
}

TEST(Check, LeavesOutWarningsThatAreMeantButInJson) {
  const Program program;
  const std::string falls = "warning: s.toml:1:1: body 'ball' falls through the ground that the film shows";
  const auto checked = [&](const std::string& meant, std::vector<std::string> more = {}) {
    std::ofstream(program.folder.path / "s.toml")
        << "[[body]]\nname = \"ball\"\nbox = { extent = [1, 1, 1], cells = [2, 2, "
           "2] }\nmaterial = \"jelly\"\n"
        << meant;
    more.insert(more.begin(), {"check", "s.toml", "--set", "camera.follow=ball"});  // so that it stays in the picture
    return run(program.folder.path, more);
  };
  EXPECT_NE(checked("").out.find(falls), std::string::npos) << checked("").out;
  EXPECT_NE(checked("").out.find("s: no errors, 1 warning; "), std::string::npos);
  const std::string meant = "meant = [\"fall\"]\n";
  EXPECT_EQ(checked(meant).out.find("warning:"), std::string::npos) << checked(meant).out;
  EXPECT_NE(checked(meant).out.find("s: no errors, 0 warnings (1 meant); "), std::string::npos);
  const auto json = nlohmann::json::parse(checked(meant, {"--json"}).out);
  ASSERT_EQ(json["warnings"].size(), 1u);
  EXPECT_EQ(json["warnings"][0]["kind"], "fall");
  EXPECT_EQ(json["warnings"][0]["meant"], true);
  EXPECT_EQ(checked("meant = [\"fal\"]\n").status, 2);
  EXPECT_NE(checked("meant = [\"fal\"]\n").err.find("; did you mean 'fall'?"), std::string::npos);
  EXPECT_EQ(checked("meant = \"fall\"\n").status, 2);
}

TEST(Completion, KnowsEveryVerbAndOptionOfTheHelp) {
  const Program program;
  const std::vector<std::string> verbs = program.verbs();
  Words expected(verbs.begin(), verbs.end());
  expected.insert({"-h", "--help", "--version"});
  EXPECT_EQ(program.completed({""}), expected);
  const std::regex option("^  (-\\w,)?(--[\\w-]+).*");
  for (const std::string& verb : verbs) {
    Words options;
    std::smatch match;
    for (const std::string& line : lines_of(program.help({verb}))) {
      if (std::regex_match(line, match, option)) options.insert(match[2]);
    }
    EXPECT_GE(options.size(), 1u) << verb;
    EXPECT_EQ(program.completed({verb, "--"}), options) << verb;
  }
}

TEST(Completion, KnowsNamesAndChoicesByTheirPlace) {
  const Program program;
  EXPECT_EQ(program.completed({"ren"}), Words{"render"});
  EXPECT_EQ(program.completed({"render", "squirrel", "--gl", ""}), (Words{"auto", "egl", "osmesa"}));
  EXPECT_EQ(program.completed({"render", "--threads", "2", "squirrel-"}), (Words{"/", "squirrel-impulsive"}));
  EXPECT_EQ(program.completed({"render", "--quiet", "squirrel-i"}), (Words{"/", "squirrel-impulsive"}));
  EXPECT_EQ(program.completed({"replay", "soft"}), (Words{"/", "softening"}));
  EXPECT_EQ(program.completed({"mesh", "bun"}), (Words{"/", "bunny"}));
  EXPECT_EQ(program.completed({"compare", "out"}), Words{"/"});
  EXPECT_EQ(program.completed({"compare", "a", "b", ""}), Words{});
  EXPECT_EQ(program.completed({"render", "--out", "x"}), Words{"/"});
  EXPECT_EQ(program.completed({"bench", "figure7"}), Words{"figure7"});
  EXPECT_EQ(program.completed({"frobnicate", ""}), Words{});
  Words scenes;
  for (const auto& entry : std::filesystem::directory_iterator(test::assets / "scenes"))
    scenes.insert(entry.path().stem());
  Words offered = program.completed({"render", ""});
  EXPECT_EQ(offered.erase("/"), 1u);
  EXPECT_EQ(offered, scenes);
  for (const auto& entry : std::filesystem::directory_iterator(test::assets / "replays")) {
    EXPECT_TRUE(scenes.insert(entry.path().stem()).second)
        << entry << ": a scene has the same name, and is found first";
  }
  for (const char* verb : {"check", "info", "profile"}) {
    offered = program.completed({verb, ""});
    EXPECT_EQ(offered.erase("/"), 1u) << verb;
    EXPECT_EQ(offered, scenes) << verb;
  }
}

// A profile cannot be resumed, because it runs the whole film in every repeat.
TEST(Help, OffersToResumeOnlyWhereAFilmCanBeResumed) {
  const Program program;
  for (const char* verb : {"render", "replay"})
    EXPECT_NE(program.help({verb}).find("--resume"), std::string::npos) << verb;
  for (const char* verb : {"profile", "sweep"})
    EXPECT_EQ(program.help({verb}).find("--resume"), std::string::npos) << verb;
}

TEST(Help, AFolderOfAScenesNameDoesNotHideTheScene) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "solvers");
  EXPECT_EQ(run(folder.path, {"check", "solvers"}).status, 0);
  const Result other = run(folder.path, {"check", "."});
  EXPECT_EQ(other.status, 2);
  EXPECT_EQ(other.err, ".: is not a file\n");
}

TEST(Check, TakesAReplayOfASceneThatHasASweep) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << "scene = \"pulled-bar\"\n";
  const Result result = run(folder.path, {"check", "s.toml"});
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST(Completion, OffersWordsAndFilesInBash) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "my run");
  const auto offered = [&](const std::string& line) {
    const std::string script = "cd '" + folder.path.string() + "'; . '" +
                               (test::assets / "completion/supple.bash").string() + "'; COMP_WORDS=('" +
                               test::program_name + "' " + line +
                               "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _supple; printf '%s|' \"${COMPREPLY[@]}\"";
    const auto end = run_program({"bash", "-c", script});
    return end ? end->output : "no bash";
  };
  EXPECT_EQ(offered("do"), "doctor|");
  EXPECT_EQ(offered("info my"), "my run|");
  EXPECT_EQ(offered("render --gl o"), "osmesa|");
}

TEST(Doctor, SaysWhatThereIsAndWhatIsMissing) {
  const Program program;
  const Result text = run(program.folder.path, {"doctor"});
  const Result json = run(program.folder.path, {"doctor", "--json"});
  EXPECT_EQ(text.status, json.status);
  const auto told = nlohmann::json::parse(json.out);
  EXPECT_EQ(told["ready"].get<bool>(), json.status == 0);
  bool ready = true;
  std::set<std::string> names;
  for (const auto& check : told["checks"]) {
    names.insert(check["name"]);
    ready &= check["ok"].get<bool>() || !check["needed"].get<bool>();
    const std::string start = check["ok"].get<bool>() ? "ok       " : "missing  ";
    EXPECT_NE(text.out.find(start + check["name"].get<std::string>()), std::string::npos) << text.out;
  }
  EXPECT_EQ(ready, told["ready"].get<bool>());
  EXPECT_EQ(names, (std::set<std::string>{"processor", "cores", "OpenGL", "ffmpeg", "ffprobe", "gnuplot", "OpenEXR",
                                          "font", "any script", "surface reader", "scenes", "cache", "disk"}));
}

TEST(Doctor, MissesWhatIsNotInPath) {
  const Program program;
  const std::string path = getenv("PATH");
  setenv("PATH", program.folder.path.c_str(), 1);
  const Result result = run(program.folder.path, {"doctor"});
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(result.status, 1) << result.out;
  EXPECT_TRUE(std::regex_search(result.out,
                                std::regex("missing  ffmpeg +not found in PATH\n +makes video.mp4; Debian: ffmpeg\n")))
      << result.out;
  EXPECT_NE(result.out.find("Debian: gnuplot-nox; a film can do without"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("A film needs what is missing above."), std::string::npos) << result.out;
}

}  // namespace manners_test
}  // namespace supple
