// Tests the manual's links and its short scenes (docs/recipes.md).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>
#include <sstream>

#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace recipes_test {

using test::read_file;
using test::Result;
using test::run;

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder, const std::string& ending) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ending) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

// Returns the text without blocks of code, in which brackets are no links.
std::string without_code(const std::string& markdown) {
  std::istringstream lines(markdown);
  std::string line, text;
  bool code = false;
  while (std::getline(lines, line)) {
    if (line.starts_with("```")) code = !code;
    if (!code) text += line + "\n";
  }
  return text;
}

// Returns the names by which links address the headings of a page.
std::set<std::string> anchors_of(const std::filesystem::path& page) {
  std::istringstream lines(without_code(read_file(page)));
  std::set<std::string> anchors;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("#")) continue;
    std::string anchor;
    for (const char c : line.substr(line.find_first_not_of("# "))) {
      if (c == ' ') anchor += '-';
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_')
        anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    anchors.insert(anchor);
  }
  return anchors;
}

void expect_target(const std::filesystem::path& page, const std::string& link) {
  const std::string file = link.substr(0, link.find('#'));
  const std::filesystem::path target = file.empty() ? page : page.parent_path() / file;
  ASSERT_TRUE(std::filesystem::exists(target)) << page << ": " << link;
  if (link.find('#') == std::string::npos) return;
  EXPECT_TRUE(anchors_of(target).contains(link.substr(link.find('#') + 1))) << page << ": " << link;
}

TEST(Manual, HasNoLinkThatLeadsNowhere) {
  std::vector<std::filesystem::path> pages = files_in(test::source_folder / "docs", ".md");
  pages.push_back(test::source_folder / "README.md");
  const std::regex link(R"(\]\(([^)\s]+)\))");
  int links = 0;
  for (const std::filesystem::path& page : pages) {
    const std::string text = without_code(read_file(page));
    for (std::sregex_iterator found(text.begin(), text.end(), link), end; found != end; ++found) {
      const std::string target = (*found)[1];
      if (target.starts_with("http")) continue;
      expect_target(page, target);
      ++links;
    }
  }
  EXPECT_GT(links, 100);
}

TEST(Recipes, AreShortHaveNothingToWarnOfAndAreNamedByTheirPage) {
  const std::filesystem::path folder = test::source_folder / "docs" / "examples" / "films";
  const std::string page = read_file(test::source_folder / "docs" / "recipes.md"), script = read_file(folder / "make");
  std::vector<std::filesystem::path> scenes = files_in(folder, ".toml");
  ASSERT_EQ(scenes.size(), 8u);
  for (const std::filesystem::path& scene : scenes) {
    const std::string text = read_file(scene), name = scene.filename().string();
    EXPECT_LE(std::ranges::count(text, '\n'), 40) << name;
    EXPECT_NE(page.find("films/" + name), std::string::npos) << name;
    EXPECT_NE(script.find("$here/" + name), std::string::npos) << name;
  }
  scenes.push_back(folder / "cushion.obj");
  const test::TemporaryFolder work;
  for (const std::filesystem::path& scene : scenes) {
    const Result checked = run(work.path, {"check", scene.string()});
    EXPECT_EQ(checked.status, 0) << checked.err;
    // A machine may lack a font for the Chinese subtitle of a scene, and check then warns of this alone.
    const bool lacks_a_font = checked.out.find(": no font has '") != std::string::npos;
    const char* const found = lacks_a_font ? "no errors, 1 warning;" : "no errors, 0 warnings";
    EXPECT_NE(checked.out.find(found), std::string::npos) << checked.out << checked.err;
  }
}

}  // namespace recipes_test
}  // namespace supple
