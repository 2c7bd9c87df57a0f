// Tests the program with colliders: what a run leaves of them, and how it refuses broken surface files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace collider_program_test {

using test::profile_of;
using test::Result;
using test::run;

const std::vector<std::string> quiet = {"--no-images", "--quiet"};

std::vector<std::string> render(const std::string& scene, const std::vector<std::string>& more = quiet) {
  std::vector<std::string> arguments = {"render", scene};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// Describes a box that falls the last millimetres.
const std::string box_scene = R"(frames = 5
[[body]]
name = "box"
box = { extent = [0.2, 0.2, 0.2], cells = [2, 2, 2] }
position = [0, 0.005, 0]
material = "jelly"
)";
const std::string ground_and_press = R"([[collider]]
name = "ground"
shape = { half_space = { normal = [0, 1, 0] } }
friction = 0.5
[[collider]]
name = "press"
shape = { box = { extent = [1, 0.1, 1] } }
position = [0, 1, 0.25]
turn_deg = [0, 180, 0]
ease = "linear"
keys = [{ t = 0 }, { t = 1, move = [0, -3, 0] }]
)";

struct Row {
  int frame;
  std::string collider;
  std::vector<double> pose;  // x y z, qw qx qy qz
};

std::vector<Row> rows_of(const std::filesystem::path& table) {
  std::istringstream in(test::read_file(table));
  std::string line, cell;
  std::getline(in, line);
  EXPECT_EQ(line, "frame,collider,x,y,z,qw,qx,qy,qz");
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    Row row;
    std::getline(cells, cell, ',');
    row.frame = std::stoi(cell);
    std::getline(cells, row.collider, ',');
    while (std::getline(cells, cell, ',')) row.pose.push_back(std::stod(cell));
    rows.push_back(std::move(row));
  }
  return rows;
}

TEST(ColliderProgram, ReportsContactsAndWhereTheCollidersWere) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << box_scene << ground_and_press;
  const Result result = run(folder.path, render("s.toml"));
  ASSERT_EQ(result.status, 0) << result.err;
  const std::filesystem::path out = folder.path / "out" / "s";
  const auto profile = profile_of(out);
  ASSERT_EQ(profile["frames"].size(), 5u);
  int touching = 0, changes = 0;
  for (const auto& frame : profile["frames"]) {
    const auto& body = frame["bodies"][0];
    for (const char* key : {"collide_ms", "contacts", "contact_changes", "contact_cycles", "penetration"})
      ASSERT_TRUE(body.contains(key) && body[key].is_number()) << key;
    EXPECT_GT(body["collide_ms"].get<double>(), 0);
    EXPECT_GE(body["penetration"].get<double>(), 0);
    EXPECT_LT(body["penetration"].get<double>(), 1e-3);
    const double phases = body["evaluate_ms"].get<double>() + body["solve_ms"].get<double>() +
                          body["lbfgs_ms"].get<double>() + body["collide_ms"].get<double>() +
                          body["matrix_ms"].get<double>() + body["other_ms"].get<double>();
    EXPECT_NEAR(phases, body["step_ms"].get<double>(), 0.01);
    ASSERT_EQ(body["colliders"].size(), 2u);
    EXPECT_EQ(body["colliders"][0]["name"], "ground");
    EXPECT_EQ(body["colliders"][0]["penetration"], body["penetration"]);
    EXPECT_EQ(body["colliders"][1]["name"], "press");
    EXPECT_EQ(body["colliders"][1]["force"], 0);
    const bool pressed = body["contacts"].get<int>() > 0;
    EXPECT_EQ(body["colliders"][0]["force"].get<double>() > 0, pressed);
    touching = std::max(touching, body["contacts"].get<int>());
    changes += body["contact_changes"].get<int>();
  }
  EXPECT_EQ(touching, 9);  // the corners of the lower face's cells
  EXPECT_GE(changes, 9);
  const std::vector<Row> rows = rows_of(out / "motion" / "colliders.csv");
  ASSERT_EQ(rows.size(), 10u);
  for (int frame = 0; frame < 5; ++frame) {
    const Row &ground = rows[2 * frame], &press = rows[2 * frame + 1];
    EXPECT_EQ(ground.frame, frame);
    EXPECT_EQ(ground.collider, "ground");
    EXPECT_EQ(ground.pose, (std::vector<double>{0, 0, 0, 1, 0, 0, 0}));
    EXPECT_EQ(press.frame, frame);
    EXPECT_EQ(press.collider, "press");
    ASSERT_EQ(press.pose.size(), 7u);
    EXPECT_NEAR(press.pose[1], 1 - (frame + 1) * 0.1, 1e-12);  // at the frame's end
    EXPECT_NEAR(press.pose[2], 0.25, 1e-12);
    EXPECT_NEAR(std::abs(press.pose[5]), 1, 1e-12);
  }
}

// The body starts deep on a post, which pushes it out no faster than it may.
TEST(ColliderProgram, WarnsOfADepthAboveAHundredthAlsoWhenQuiet) {
  const test::TemporaryFolder folder;
  const std::string post =
      "start_inside = \"push\"\n[[collider]]\nname = \"post\"\n"
      "shape = { capsule = { ends = [[0.02, -1, 0.02], [0.02, 0, 0.02]], radius = 0.06 } }\n";
  std::ofstream(folder.path / "s.toml") << box_scene << post;
  const Result result = run(folder.path, render("s.toml"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("warning: the surface of body 'box' was up to "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("% of its size deep inside collider 'post' (at frame "), std::string::npos) << result.err;
  std::ofstream(folder.path / "s.toml") << box_scene << ground_and_press;
  EXPECT_EQ(run(folder.path, render("s.toml", {"--no-images", "--quiet", "--force"})).err, "");
}

TEST(ColliderProgram, SaysNothingOfContactsWithoutColliders) {
  const test::TemporaryFolder folder;
  const std::filesystem::path scene = folder.path / "s.toml", out = folder.path / "out" / "s";
  std::ofstream(scene) << box_scene << ground_and_press;
  const Result with = run(folder.path, render("s.toml", {"--no-images"}));
  ASSERT_EQ(with.status, 0) << with.err;
  EXPECT_NE(with.out.find("penetration"), std::string::npos);
  ASSERT_TRUE(std::filesystem::exists(out / "motion" / "colliders.csv"));
  std::ofstream(scene) << box_scene;
  const Result without = run(folder.path, render("s.toml", {"--no-images", "--force"}));
  ASSERT_EQ(without.status, 0) << without.err;
  EXPECT_EQ(without.out.find("penetration"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(out / "motion" / "colliders.csv"));  // nor the run's before
  const auto profile = profile_of(out);
  ASSERT_EQ(profile["frames"].size(), 5u);
  for (const auto& frame : profile["frames"])
    for (const char* key : {"collide_ms", "contacts", "contact_changes", "contact_cycles", "penetration"})
      EXPECT_FALSE(frame["bodies"][0].contains(key)) << key;
}

TEST(ColliderProgram, FilmsASceneOfAFewLines) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << R"(frames = 3
[[body]]
surface = "surfaces/stairs.obj"
material = "jelly"
[[collider]]
shape = { half_space = { normal = [0, 1, 0] } }
)";
  const Result result = run(folder.path, render("s.toml", {"--no-video", "--set", "output.width=160", "--set",
                                                           "output.height=90", "--set", "body.body.vertices=400"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const std::filesystem::path out = folder.path / "out" / "s";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(out / "frames"), {}), 3);
  EXPECT_EQ(rows_of(out / "motion" / "colliders.csv").size(), 3u);
  EXPECT_GT(profile_of(out)["frames"][2]["bodies"][0]["contacts"].get<int>(), 0);
}

std::string stl_of(std::uint32_t claimed, std::size_t triangles) {
  std::string bytes(80, ' ');
  for (int k = 0; k < 4; ++k) bytes += char(claimed >> 8 * k & 0xff);
  return bytes + std::string(50 * triangles, '\0');
}

// Writes broken surfaces and returns their names; the last one is a folder.
std::vector<std::string> write_broken_surfaces(const std::filesystem::path& folder) {
  const std::pair<const char*, std::string> files[] = {
      {"cut.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
       "property float z\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n0123456789"},
      {"cut-text.ply",
       "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 12\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n0 0"},
      {"nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"},
      {"empty.stl", ""},
      {"none.stl", stl_of(0, 0)},
      {"many.stl", stl_of(0xFFFFFFFFu, 4)}};
  std::vector<std::string> names;
  for (const auto& [name, bytes] : files) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    names.push_back(name);
  }
  std::filesystem::create_directory(folder / "folder.stl");
  names.push_back("folder.stl");
  return names;
}

// Returns every file below a folder, with its content.
std::map<std::string, std::string> contents_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    contents[entry.path().string()] = entry.is_regular_file() ? test::read_file(entry.path()) : "";
  return contents;
}

TEST(ColliderProgram, RefusesBrokenSurfacesInOneLineAndLeavesTheRunBeforeAlone) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "good.toml") << box_scene;
  ASSERT_EQ(run(folder.path, render("good.toml", {"--no-images", "--quiet", "--out", "kept"})).status, 0);
  const auto kept = contents_of(folder.path / "kept");
  ASSERT_GT(kept.size(), 3u);
  for (const std::string& name : write_broken_surfaces(folder.path)) {
    std::ofstream(folder.path / "body.toml") << fmt::format("[[body]]\nsurface = \"{}\"\nmaterial = \"jelly\"\n", name);
    std::ofstream(folder.path / "collider.toml")
        << box_scene << fmt::format("[[collider]]\nshape = {{ surface = \"{}\" }}\n", name);
    for (const char* scene : {"body.toml", "collider.toml"}) {
      const Result result = run(folder.path, render(scene, {"--no-images", "--out", "kept"}));
      EXPECT_EQ(result.status, 2) << name << " in " << scene << ": " << result.err;
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1)
          << name << " in " << scene << ": " << result.err;
      EXPECT_EQ(result.err.find(name), 0u) << name << " in " << scene << ": " << result.err;
      EXPECT_GT(result.err.size(), name.size() + 5) << scene;
      EXPECT_EQ(result.out, "") << name << " in " << scene;
      EXPECT_EQ(contents_of(folder.path / "kept"), kept) << name << " in " << scene;
      EXPECT_FALSE(std::filesystem::exists(folder.path / "out"));
    }
  }
}

}  // namespace collider_program_test
}  // namespace supple
