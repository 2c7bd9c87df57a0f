// Meshes and skins that are kept from run to run change no result.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "output/files/obj_file.h"
#include "support/bodies.h"
#include "support/program.h"
#include "support/surfaces.h"

namespace supple {
namespace mesh_cache_test {

namespace fs = std::filesystem;
using test::Result;
using test::run;

std::vector<fs::path> entries_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) files.push_back(entry.path());
  return files;
}

class MeshCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    write_torus(0.4);
    write_scene();
    if (const char* before = std::getenv("XDG_CACHE_HOME")) before_ = before;
    setenv("XDG_CACHE_HOME", (folder_.path / "caches").c_str(), 1);
  }
  void TearDown() override { before_ ? setenv("XDG_CACHE_HOME", before_->c_str(), 1) : unsetenv("XDG_CACHE_HOME"); }

  void write_torus(double tube) {
    const TriMesh torus = test::torus_surface(1, tube, 24, 12);
    write_obj(folder_.path / "torus.obj", torus.points, torus.triangles);
  }

  void write_scene(const std::string& more = "") {
    std::ofstream(folder_.path / "s.toml")
        << "frames = 2\n[[body]]\nname = \"head\"\nshape = \"shapes/squirrel.toml\"\n"
           "vertices = 600\nsize = 0.4\nskin_cells = 16\nmaterial = \"jelly\"\n"
           "[[body]]\nname = \"ring\"\nsurface = \"torus.obj\"\nvertices = 400\n"
           "size = 0.4\nposition = [0.6, 0, 0]\nmaterial = \"jelly\"\n"
        << more << "[output]\nwidth = 160\nheight = 90\nsamples = 1\n";
  }

  // Films into a folder and returns what the run left of states and pictures.
  std::string film(const std::string& out, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"render", "s.toml", "--quiet", "--no-video", "--gl", "osmesa", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    const Result result = run(folder_.path, words);
    EXPECT_EQ(result.status, 0) << result.err;
    std::string left;
    const auto whole = test::profile_of(folder_.path / out);
    for (const auto& frame : whole["frames"]) left += frame["state_hash"];
    return left + test::read_file(folder_.path / out / "frames" / "000001.png");
  }

  std::vector<fs::path> entries() const { return entries_in(folder_.path / "caches" / "supple"); }

  const test::TemporaryFolder folder_;
  std::optional<std::string> before_;
};

TEST_F(MeshCacheTest, ChangesNeitherStatesNorPictures) {
  const std::string without = film("a", {"--no-cache"});
  EXPECT_TRUE(entries().empty());
  EXPECT_EQ(film("b"), without);
  EXPECT_EQ(entries().size(), 4u) << "a mesh and a skin of each body";
  EXPECT_EQ(film("c"), without);
  EXPECT_EQ(entries().size(), 4u);
}

TEST_F(MeshCacheTest, TakesEntriesFromTheCacheAndNoDamagedOnes) {
  const std::string without = film("a");
  // A run that made everything anew would write all entries again.
  std::map<fs::path, fs::file_time_type> times;
  const auto old = fs::file_time_type::clock::now() - std::chrono::hours(2);
  for (const fs::path& entry : entries()) {
    fs::permissions(entry, fs::perms::owner_read);
    fs::last_write_time(entry, old);
    std::ofstream(entry.string() + ".copy", std::ios::binary) << test::read_file(entry);
  }
  EXPECT_EQ(film("b"), without);
  for (const fs::path& entry : entries()) {
    if (entry.extension() == ".copy") continue;
    EXPECT_GT(fs::last_write_time(entry), old) << "it was used";
    EXPECT_EQ(fs::status(entry).permissions(), fs::perms::owner_read) << "it was not written again";
    fs::remove(entry);
    std::ofstream(entry, std::ios::binary) << test::read_file(entry.string() + ".copy").substr(0, 1000);
  }
  EXPECT_EQ(film("c"), without);
  for (const fs::path& entry : entries()) {
    if (entry.extension() == ".copy") continue;
    EXPECT_EQ(test::read_file(entry), test::read_file(entry.string() + ".copy")) << "it was made again";
  }
}

TEST_F(MeshCacheTest, NoticesThatASurfaceHasChanged) {
  const std::string before = film("a");
  write_torus(0.3);
  const std::string with = film("b"), without = film("c", {"--no-cache"});
  EXPECT_EQ(with, without);
  EXPECT_NE(with, before);
}

TEST_F(MeshCacheTest, ServesChecksAndResumedFilms) {
  EXPECT_EQ(run(folder_.path, {"check", "s.toml", "--no-cache"}).status, 0);
  EXPECT_TRUE(entries().empty());
  EXPECT_EQ(run(folder_.path, {"check", "s.toml"}).status, 0);
  EXPECT_EQ(entries().size(), 6u) << "meshes and skins, and the meshes of a rough first pass";
  film("a", {"--frames", "1"});
  EXPECT_EQ(entries().size(), 6u);
  EXPECT_EQ(film("a", {"--resume"}), film("b", {"--no-cache"}));
}

TEST_F(MeshCacheTest, IsSharedByRunsAtTheSameTime) {
  std::array<std::string, 3> left;
  std::vector<std::thread> runs;
  for (std::size_t i = 0; i < left.size(); ++i)
    runs.emplace_back([&, i] {
      const fs::path place = folder_.path / std::to_string(i);
      fs::create_directories(place);
      const Result result = run(place, {"render", "../s.toml", "--quiet", "--no-images"});
      EXPECT_EQ(result.status, 0) << result.err;
      const auto whole = test::profile_of(place / "out" / "s");
      for (const auto& frame : whole["frames"]) left[i] += frame["state_hash"];
    });
  for (std::thread& thread : runs) thread.join();
  EXPECT_EQ(left[0], left[1]);
  EXPECT_EQ(left[0], left[2]);
  EXPECT_EQ(entries().size(), 2u);
}

TEST_F(MeshCacheTest, IsNotNeeded) {
  unsetenv("XDG_CACHE_HOME");
  const std::string home = std::getenv("HOME") == nullptr ? "" : std::getenv("HOME");
  unsetenv("HOME");
  const std::string without = film("a");
  setenv("HOME", (folder_.path / "s.toml").c_str(), 1);  // no folder can be made there
  EXPECT_EQ(film("b"), without);
  home.empty() ? unsetenv("HOME") : setenv("HOME", home.c_str(), 1);
}

}  // namespace mesh_cache_test
}  // namespace supple
