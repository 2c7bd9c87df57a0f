// Films a small scene that a replay changes in every way, as a user does.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "output/video/video.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple::test {

// Films a bar and a cloth, which are changed in every way, at a small size.
class ReplayedFilm : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path / "two.toml") << R"(frames = 24
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [10, 3, 3] }
position = [0, 0.3, 0]
material = { model = "neo-hookean", mu = 2e4, lambda = 4e4 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
keys = [{ t = 0 }, { t = 0.4, move = [0, 0.1, 0] }, { t = 0.8 }]
[[body]]
name = "sheet"
cloth = { extent = [0.4, 0.4], cells = [10, 10], stretch = 100, bend = 1 }
turn_deg = [90, 0, 0]
position = [0, 0.25, 0]
[[collider]]
name = "ball"
shape = { sphere = { radius = 0.1 } }
position = [0, 0.1, 0]
[output]
width = 96
height = 64
samples = 1
)";
    std::ofstream(folder_.path / "r.toml") << R"(scene = "two.toml"
[[grab]]
body = "bar"
name = "fingers"
select = { box = [[0.9, 0, 0], [1, 1, 1]] }
stiffness = 30
from = 0.1
until = 0.5
keys = [{ t = 0.1 }, { t = 0.4, move = [0.05, 0.1, 0], turn_deg = [20, 0, 0] }]
[[change]]
t = 0.2
over = 0.3
by = "ratio"
path = "body.bar.material.mu"
value = 2e5
[[change]]
t = 0.3
path = "body.sheet.cloth.stretch"
value = 300
[[change]]
t = 0.3
over = 0.2
path = "collider.ball.shape.sphere.radius"
value = 0.14
[[change]]
t = 0.1
over = 0.4
path = "collider.ball.position"
value = [0.05, 0.1, 0.02]
[[change]]
frame = 12
path = "substeps"
value = 2
[[change]]
frame = 16
path = "body.bar.solver.method"
value = "newton"
[[change]]
frame = 18
path = "body.bar.solver.integrator"
value = "implicit-midpoint"
[[change]]
frame = 9
path = "body.bar.label"
value = "pulled"
[[change]]
t = 0.1
over = 0.5
path = "camera.margin"
value = 1.6
)";
  }

  std::vector<std::string> film(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"replay", "r.toml", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::vector<std::string> hashes(const std::string& out) const {
    std::vector<std::string> list;
    const auto profile = profile_of(folder_.path / out);
    for (const auto& frame : profile["frames"]) list.push_back(frame["state_hash"]);
    return list;
  }
  std::vector<std::string> pictures(const std::string& out) const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path / out / "frames")) files.push_back(entry);
    std::sort(files.begin(), files.end());
    std::vector<std::string> contents;
    for (const std::filesystem::path& file : files) contents.push_back(read_file(file));
    return contents;
  }
  // Compares everything that a film consists of, except for times.
  void expect_the_same_film(const std::string& a, const std::string& b) const {
    EXPECT_EQ(hashes(a), hashes(b));
    EXPECT_EQ(pictures(a), pictures(b));
    for (const char* file : {"motion/bar.pc2", "motion/sheet.pc2", "motion/colliders.csv"})
      EXPECT_EQ(read_file(folder_.path / a / file), read_file(folder_.path / b / file)) << file;
    if (std::filesystem::exists(folder_.path / a / "video.mp4")) {
      EXPECT_EQ(count_video_frames(folder_.path / b / "video.mp4"), long(hashes(b).size()));
      EXPECT_EQ(read_file(folder_.path / b / "video.mp4"), read_file(folder_.path / a / "video.mp4"));
    }
  }

  TemporaryFolder folder_;
};

}  // namespace supple::test
