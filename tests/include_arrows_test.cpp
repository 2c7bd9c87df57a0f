// Reads every #include of this project, compares it with the allowed directions between the folders, and checks that
// headers of third parties are included only where they may be.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "support/bodies.h"

namespace supple {
namespace include_arrows_test {

const std::map<std::string, std::set<std::string>> allowed = {
    {"base", {"base"}},
    {"geometry", {"geometry", "base"}},
    {"sim", {"sim", "geometry", "base"}},
    {"baselines", {"baselines", "sim", "geometry", "base"}},
    {"scene", {"scene", "sim", "geometry", "base"}},
    {"world", {"world", "scene", "sim", "geometry", "base"}},
    {"render", {"render", "base"}},
    {"output", {"output", "geometry", "base"}},
    {"film", {"film", "world", "scene", "sim", "render", "output", "geometry", "base"}},
    {"live", {"live", "film", "world", "scene", "sim", "render", "output", "geometry", "base"}},
};

// Lists the rooms of the folders that have some, and those from which each may include, itself apart. A file that lies
// in a folder but in none of its rooms stands in the corridor: it may include from all of them.
const std::map<std::string, std::map<std::string, std::set<std::string>>> rooms = {
    {"geometry",
     {{"meshes", {}},
      {"triangles", {"meshes"}},
      {"solids", {"triangles", "meshes"}},
      {"files", {"solids", "meshes"}},
      {"shapes", {"files", "solids", "meshes"}},
      {"skins", {"shapes", "files", "triangles", "meshes"}},
      {"tetrahedra", {"skins", "shapes", "solids", "triangles", "meshes"}},
      {"reader", {"files"}}}},
    {"sim",
     {{"materials", {}},
      {"elements", {"materials"}},
      {"linear", {}},
      {"model", {"linear", "elements", "materials"}},
      {"air", {"model", "linear", "elements", "materials"}},
      {"coarse", {"model", "linear", "elements", "materials"}},
      {"contact", {"coarse", "model", "linear", "elements", "materials"}},
      {"solver", {"air", "contact", "coarse", "model", "linear", "elements", "materials"}},
      {"measures", {"solver", "air", "contact", "coarse", "model", "linear", "elements", "materials"}}}},
    {"scene",
     {{"config", {}},
      {"definition", {}},
      {"reading", {"config", "definition"}},
      {"building", {"reading", "definition"}},
      {"replay", {"building", "reading", "config", "definition"}}}},
    {"output",
     {{"files", {}},
      {"motion", {"files"}},
      {"run", {"motion", "files"}},
      {"video", {"run", "files"}},
      {"pages", {"run", "files"}}}},
    {"film", {{"plan", {}}, {"record", {"plan"}}, {"pictures", {"plan"}}, {"redraw", {"pictures", "record", "plan"}}}},
};

// Lists headers of third parties, and the files that may include them.
const std::vector<std::pair<std::regex, std::regex>> cages = {
    {std::regex("cholmod\\.h"), std::regex("engine/sim/linear/cholesky\\.cpp")},
    {std::regex("png\\.h"), std::regex("engine/(output/files/png_file|geometry/reader/texture_reader)\\.cpp")},
    {std::regex("jpeglib\\.h"), std::regex("engine/(output/files/jpeg|geometry/reader/texture_reader)\\.cpp")},
    {std::regex("microhttpd\\.h"), std::regex("engine/live/(server\\.cpp|response\\.h)")},
    {std::regex("stb/.*"), std::regex("engine/geometry/reader/texture_reader\\.cpp")},
    {std::regex("(GL|EGL)/.*"), std::regex("engine/render/.*")},
    {std::regex("fontconfig/.*"), std::regex("engine/render/font_search\\.cpp")},
    {std::regex("raqm\\.h"), std::regex("engine/render/text_bitmap\\.cpp")},
    {std::regex("ft2build\\.h"), std::regex("engine/render/text_bitmap\\.cpp")},
    {std::regex("toml\\+\\+/.*"), std::regex("engine/scene/config/toml_document\\.h")},
    {std::regex("assimp/.*"),
     std::regex("engine/geometry/reader/assimp_(reader\\.cpp|(colors|files|parts)\\.(h|cpp))")},
    {std::regex("meshoptimizer\\.h"), std::regex("engine/geometry/skins/simplify\\.cpp")},
    {std::regex("xxhash\\.h"), std::regex("engine/base/hash\\.cpp")},
    {std::regex("CLI/.*"), std::regex("app/command_line\\.cpp")},
    {std::regex("nlohmann/json\\.hpp"), std::regex(".*\\.cpp")},
};

struct Include {
  std::string file;  // relative to the project
  std::string name;
};

std::vector<Include> all_includes() {
  std::vector<Include> includes;
  const std::regex pattern("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"].*");
  for (const char* top : {"app", "engine"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(test::source_folder / top)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        std::smatch match;
        if (std::regex_match(line, match, pattern)) {
          includes.push_back({std::filesystem::relative(entry.path(), test::source_folder).string(), match[1].str()});
        }
      }
    }
  }
  return includes;
}

TEST(House, EveryIncludeFollowsTheArrows) {
  int checked = 0;
  for (const Include& include : all_includes()) {
    const std::string target = include.name.substr(0, include.name.find('/'));
    if (include.file.starts_with("app/")) continue;
    EXPECT_NE(target, "app") << include.file;
    if (!allowed.contains(target)) continue;  // not a folder of ours
    const std::string rest = include.file.substr(std::string("engine/").size());
    const std::string folder = rest.substr(0, rest.find('/'));
    ASSERT_TRUE(allowed.contains(folder)) << include.file << " lies in a folder that the house does not have";
    EXPECT_TRUE(allowed.at(folder).contains(target)) << include.file << " includes " << include.name;
    ++checked;
  }
  EXPECT_GT(checked, 50);
}

// Two types of one name in two libraries are one type to the linker, which takes the functions of either for both.
TEST(House, NoHeaderDefinesATypeThatAnotherDefines) {
  const std::regex pattern("(?:template <.*> ?)?(?:struct|class|enum class) (\\w+)(?: final)?(?: : .*)? \\{.*");
  std::map<std::string, std::string> home;
  for (const char* top : {"app", "engine"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(test::source_folder / top)) {
      if (entry.path().extension() != ".h") continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        std::smatch match;
        if (!std::regex_match(line, match, pattern)) continue;
        const auto [known, is_new] = home.try_emplace(match[1].str(), entry.path().string());
        EXPECT_TRUE(is_new) << match[1] << " is defined by " << known->second << " and by " << entry.path().string();
      }
    }
  }
  EXPECT_GT(home.size(), 300u);
}

// Returns the room of a path such as sim/model/state.h, and "corridor" for one such as sim/sim.h.
std::string room_of(const std::string& path) {
  const std::size_t first = path.find('/'), second = path.find('/', first + 1);
  return second == std::string::npos ? "corridor" : path.substr(first + 1, second - first - 1);
}

TEST(House, RoomsOfAFolderLookOneWay) {
  std::map<std::string, int> checked;
  for (const Include& include : all_includes()) {
    if (!include.file.starts_with("engine/")) continue;
    const std::string file = include.file.substr(std::string("engine/").size());
    const std::string folder = file.substr(0, file.find('/'));
    if (!rooms.contains(folder) || !include.name.starts_with(folder + "/")) continue;
    const std::string from = room_of(file), to = room_of(include.name);
    if (from == "corridor" || from == to) continue;
    ASSERT_TRUE(rooms.at(folder).contains(from)) << include.file << " lies in a room that the house does not have";
    EXPECT_TRUE(rooms.at(folder).at(from).contains(to)) << include.file << " includes " << include.name;
    ++checked[folder];
  }
  for (const auto& [folder, arrows] : rooms) EXPECT_GT(checked[folder], 5) << folder;
}

// Returns these headers of the engine and all headers that they include, and so on.
std::set<std::string> reached_from(const std::set<std::string>& headers) {
  std::multimap<std::string, std::string> includes;
  for (const Include& include : all_includes()) includes.emplace(include.file, include.name);
  std::vector<std::string> open(headers.begin(), headers.end());
  std::set<std::string> seen = headers;
  while (!open.empty()) {
    const auto [begin, end] = includes.equal_range("engine/" + open.back());
    open.pop_back();
    for (auto at = begin; at != end; ++at) {
      if (seen.insert(at->second).second) open.push_back(at->second);
    }
  }
  return seen;
}

// The definition of a scene does not depend on how files are read.
TEST(House, DefinitionsOfScenesIncludeNoReader) {
  const std::set<std::string> seen = reached_from({"scene/definition/scene_def.h"});
  EXPECT_GT(seen.size(), 20u);
  for (const char* reader : {"scene/config/config.h", "scene/config/toml_document.h", "toml++/toml.h"})
    EXPECT_FALSE(seen.contains(reader)) << reader;
}

// Other programs include neither the memory of steps nor how files are read (cmake/install_headers.cmake).
TEST(House, InstalledHeadersShowNoInnerRooms) {
  const std::regex inner(
      "sim/(air|coarse|contact)/.*|sim/elements/element_kernels\\.h|sim/solver/open_workspace\\.h|"
      "geometry/triangles/.*|scene/config/config\\.h|world/islands\\.h");
  const std::set<std::string> seen =
      reached_from({"base/error.h", "base/threads.h", "baselines/make_rule.h", "sim/sim.h", "world/world.h"});
  EXPECT_TRUE(seen.contains("sim/model/model.h"));
  for (const std::string& header : seen) EXPECT_FALSE(std::regex_match(header, inner)) << header;
}

// The benchmarks use the engine directly and do not depend on the verbs. The verbs know their names, and their program
// runs them.
TEST(House, BenchmarksAndVerbsMeetInTwoHeaders) {
  std::set<std::string> entries;
  for (const Include& include : all_includes()) {
    if (include.file.starts_with("app/bench/")) {
      EXPECT_TRUE(!include.name.starts_with("app/") || include.name.starts_with("app/bench/"))
          << include.file << " includes " << include.name;
    } else if (include.name.starts_with("app/bench/")) {
      entries.insert(include.file + " includes " + include.name);
    }
  }
  EXPECT_EQ(entries, (std::set<std::string>{"app/bench_main.cpp includes app/bench/bench.h",
                                            "app/bench_main.cpp includes app/bench/names.h",
                                            "app/bench_verb.cpp includes app/bench/names.h"}));
}

TEST(House, ThirdPartiesStayInTheirCages) {
  int seen = 0;
  for (const Include& include : all_includes()) {
    for (const auto& [header, place] : cages) {
      if (!std::regex_match(include.name, header)) continue;
      EXPECT_TRUE(std::regex_match(include.file, place)) << include.file << " includes " << include.name;
      ++seen;
    }
  }
  EXPECT_GE(seen, static_cast<int>(cages.size()));
}

}  // namespace include_arrows_test
}  // namespace supple
