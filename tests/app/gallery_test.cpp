// Tests `supple gallery`, which films many scenes onto one page.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "output/run/run_folder.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace gallery_test {

using test::read_file;
using test::Result;
using test::run;

std::string bar(const std::string& density) {
  return "title = \"A bar of " + density + R"(, <b>wide</b>"
frames = 5
[[body]]
name = "bar"
box = { extent = [0.4, 0.2, 0.2], cells = [4, 2, 2] }
material = "jelly"
density = )" +
         density + "\n[output]\nwidth = 320\nheight = 180\nsamples = 1\n";
}

class Gallery : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(path("scenes"));
    write("light", bar("100"));
    write("heavy", bar("900"));
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path("scenes/" + name + ".toml")) << text;
  }
  std::filesystem::path path(const std::string& name) const { return folder_.path / name; }
  Result gallery(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"gallery", "scenes", "--width", "64"});
    return run(folder_.path, more);
  }
  std::string page() const { return read_file(path("out/gallery/index.html")); }
  nlohmann::json info(const std::string& scene) const {
    return nlohmann::json::parse(read_file(path("out/gallery/runs/" + scene + "/run.json")));
  }

  test::TemporaryFolder folder_;
};

TEST_F(Gallery, ShowsEveryFilmOnOnePageWithinItsBounds) {
  const Result result = gallery({"--frames", "3"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string html = page();
  EXPECT_NE(html.find("2 of 2 filmed."), std::string::npos);
  EXPECT_NE(html.find("A bar of 900, &lt;b&gt;wide&lt;/b&gt;"), std::string::npos);
  EXPECT_FALSE(std::regex_search(html.substr(0, 20000), std::regex("(src|href)=\"(?!data:|#)")))
      << "something is loaded";
  EXPECT_EQ(info("light")["frames"], 3);
  EXPECT_EQ(info("light")["scene"]["output"]["width"], 64);
  EXPECT_EQ(info("light")["scene"]["output"]["height"], 36);
  ASSERT_EQ(run(folder_.path, {"gallery", "scenes", "--preview", "--out", "small", "--quiet"}).status, 0);
  EXPECT_NE(read_file(path("small/index.html")).find("2 of 2 filmed as previews."), std::string::npos);
}

TEST_F(Gallery, FilmsAgainOnlyWhatHasChanged) {
  ASSERT_EQ(gallery().status, 0);
  const auto time_of = [this](const char* scene) {
    return std::filesystem::last_write_time(path("out/gallery/runs") / scene / "run.json");
  };
  const auto light = time_of("light"), heavy = time_of("heavy");
  write("heavy", bar("950"));
  const Result again = gallery();
  ASSERT_EQ(again.status, 0);
  EXPECT_NE(again.err.find("1 of 2 scenes are done\n"), std::string::npos) << again.err;
  EXPECT_EQ(time_of("light"), light);
  EXPECT_NE(time_of("heavy"), heavy);
  ASSERT_EQ(gallery({"--again"}).status, 0);
  EXPECT_NE(time_of("light"), light);
}

TEST_F(Gallery, ShowsAFailedSceneAndFilmsTheOthers) {
  write("broken", "frmes = 3\n" + bar("200"));
  write("refused", bar("900") + "[field]\nquantity = \"stretch\"\nrange = \"film\"\n");
  const Result result = gallery();
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("  broken: scenes/broken.toml:1:1: unknown key 'frmes'"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("  refused: field.range: \"film\" is known only"), std::string::npos) << result.err;
  const std::string html = page();
  EXPECT_NE(html.find("2 of 4 filmed."), std::string::npos);
  EXPECT_NE(html.find("unknown key &#39;frmes&#39;"), std::string::npos);
  EXPECT_NE(html.find("A bar of 100"), std::string::npos);
  EXPECT_EQ(info("light")["ended"], "done");
  write("broken", bar("200"));
  const Result again = gallery();
  EXPECT_EQ(again.status, 1) << "one scene still fails";
  EXPECT_NE(again.err.find("2 of 4 scenes are done\n"), std::string::npos) << again.err;
  EXPECT_EQ(info("broken")["ended"], "done");
}

TEST_F(Gallery, GoesOnWhereItWasInterrupted) {
  std::string slow = bar("900");
  slow.replace(slow.find("frames = 5"), 10, "frames = 100000");
  write("slow", slow);
  const Result cut =
      run(folder_.path, {"gallery", "scenes", "--width", "64"}, path("out/gallery/runs/slow/frames/000001.png"));
  ASSERT_EQ(cut.status, 130) << cut.err;
  EXPECT_NE(page().find("2 of 3 filmed."), std::string::npos);
  EXPECT_NE(page().find("not filmed yet"), std::string::npos);
  const Result on = gallery({"--frames", "5"});  // other bounds: the slow scene alone is asked for in another way
  ASSERT_EQ(on.status, 0) << on.err;
  EXPECT_NE(on.err.find("2 of 3 scenes are done\n"), std::string::npos) << on.err;
}

TEST_F(Gallery, RefusesFoldersThatAreNotItsOwn) {
  std::filesystem::create_directory(path("empty"));
  EXPECT_EQ(run(folder_.path, {"gallery", "empty"}).err, "empty: holds no scene (.toml)\n");
  EXPECT_EQ(run(folder_.path, {"gallery", "none"}).err, "none: is not a folder of scenes\n");
  const Result other = gallery({"--out", "scenes"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("holds files that no gallery left there"), std::string::npos) << other.err;
  EXPECT_EQ(gallery({"--preview"}).status, 2) << "--width and --preview contradict each other";
  EXPECT_EQ(gallery({"--frames", "0"}).status, 2);
}

}  // namespace gallery_test
}  // namespace supple
