// Tests what `supple info` prints about a mesh, a surface, a scene and the folder of a run.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>

#include "support/bodies.h"
#include "support/program.h"
#include "support/surfaces.h"

namespace supple {
namespace info_test {

using test::Result;
using test::run;

constexpr const char* bar_scene = R"(title = "A bar"
frames = 4
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [4, 2, 2] }
material = { model = "neo-hookean", young = 1e5, poisson = 0.3 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
[[collider]]
name = "floor"
shape = { half_space = { normal = [0, 1, 0] } }
)";

void expect_lines(const std::string& text, const std::vector<std::string>& lines) {
  for (const std::string& line : lines)
    EXPECT_NE(text.find(line), std::string::npos) << line << "\nis not in\n" << text;
}

TEST(Info, TellsOfASceneAndWhatAFrameCosts) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "bar.toml") << bar_scene;
  const Result result = run(folder.path, {"info", "bar.toml"});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_lines(result.out,
               {"scene           bar: A bar\n", "film            4 frames at 30 a second (0.1 s), one step of",
                "collider        'floor', friction 0\n", "body 'bar'\n", "45 vertices, ", "elements of neo-hookean\n",
                "handle          'end' holds 9 vertices around (", "quasi-newton, 10 iterations a step",
                "ms a frame (median of the first 4, "});
  EXPECT_FALSE(std::filesystem::exists(folder.path / "out"));
  EXPECT_EQ(run(folder.path, {"info", "thin-sheet"}).status, 0);
  expect_lines(run(folder.path, {"info", "tightening"}).out, {"changes         ", " while it runs\n"});
}

TEST(Info, SaysWhereItsCostIsThatOfAFreeFall) {
  const test::TemporaryFolder folder;
  std::string scene = bar_scene;
  scene.erase(scene.find("[[body.handles]]"), scene.find("[[collider]]") - scene.find("[[body.handles]]"));
  std::ofstream(folder.path / "low.toml") << scene;
  std::ofstream(folder.path / "high.toml") << scene.insert(scene.find("material"), "position = [0, 5, 0]\n");
  const std::string words = "threads; it touches nothing in them, and contacts cost more)\n";
  EXPECT_NE(run(folder.path, {"info", "high.toml"}).out.find(words), std::string::npos);
  EXPECT_EQ(run(folder.path, {"info", "low.toml"}).out.find(words), std::string::npos);
}

TEST(Info, TellsHowAColliderDeforms) {
  const test::TemporaryFolder folder;
  for (const char* name : {"ball.obj", "ball_0.obj", "ball_1.obj", "ball_2.obj"})
    std::ofstream(folder.path / name) << test::obj_text(test::sphere_surface(0.2, 8, 5));
  std::string scene = bar_scene;
  scene.insert(scene.find("[[collider]]"),
               "[[collider]]\nname = \"ball\"\nshape = { surface = \"ball.obj\" }\nposition = [0, -5, 0]\n"
               "motion = { file = \"ball_*.obj\", fps = 60, start = 0.5 }\n");
  std::ofstream(folder.path / "bar.toml") << scene;
  const Result result = run(folder.path, {"info", "bar.toml"});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_lines(result.out, {"collider        'ball', friction 0, deforms: 3 frames at 60 a second from 0.5 s on\n"
                            "collider        'floor', friction 0\n"});
}

TEST(Info, GivesTheTerminalNoOrdersOfAScene) {
  const test::TemporaryFolder folder;
  std::string scene = bar_scene;
  scene.replace(scene.find("A bar"), 5, "A\\u001B[2J\\nbar");
  std::ofstream(folder.path / "bar.toml") << scene;
  const Result good = run(folder.path, {"info", "bar.toml"});
  EXPECT_NE(good.out.find("bar: A\\x1b[2J\\nbar\n"), std::string::npos) << good.out;
  scene.replace(scene.find("\"bar\""), 5, "\"b\\nr\"");
  std::ofstream(folder.path / "bar.toml") << scene;
  EXPECT_EQ(run(folder.path, {"info", "bar.toml"}).err,
            "bar.toml:4:8: name: must be a word without control characters, spaces, dots and slashes\n");
}

TEST(Info, ListsTheChangesOfAReplayAndWhatTheyCost) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "bar.toml") << bar_scene;
  std::ofstream(folder.path / "r.toml") << R"(scene = "bar.toml"
frames = 12
[[change]]
t = 0.2
over = 0.1
by = "ratio"
path = "body.bar.material.young"
value = 2e5
[[change]]
t = 0.1
path = "body.bar.solver.method"
value = "newton"
[[change]]
frame = 5
frames = 2
ease = "linear"
path = "gravity"
value = [0, -3, 0]
[[change]]
t = 0
path = "collider.floor.friction"
value = 0.5
[[change]]
t = 9
path = "body.bar.material"
value = { model = "corotated", mu = 2e4 }
)";
  const Result result = run(folder.path, {"info", "r.toml"});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_lines(
      result.out,
      {"changes         5 while it runs\n"
       "  0 s           collider.floor.friction becomes 0.5; before the first frame\n"
       "  0.1 s         body.bar.solver.method becomes newton; in frame 3: the method starts anew\n"
       "  0.166667 s    gravity from [0, -9.81, 0] to [0, -3, 0] over 0.0666667 s, linear; in frames 5 to 6\n"
       "  0.2 s         body.bar.material.young from 100000 to 200000 over 0.1 s, smooth by ratio; in frames 6 "
       "to 8, each: a new factor\n"
       "  9 s           body.bar.material becomes {model = corotated, mu = 20000}; not in this film\n"});
}

TEST(Info, TellsOfARun) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "bar.toml") << bar_scene;
  ASSERT_EQ(run(folder.path, {"render", "bar.toml", "--no-images", "--quiet", "--error-every", "2", "--out", "my run"})
                .status,
            0);
  const Result result = run(folder.path, {"info", "my run"});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_lines(
      result.out,
      {"run             my run\n", "render bar.toml --no-images --quiet --error-every 2 --out 'my run'\n",
       "/bar.toml\n", "body            'bar': 45 vertices", "ended           done\n",
       "frames          4 in profile.json, 0 pictures\n", "film            none\n",
       "errors          measured at 2 of 4 frames\n", "ms/frame", "error mean", "    motion/ ", "    profile.json "});
}

TEST(Info, TellsOfARunThatWasKilled) {
  const test::TemporaryFolder folder;
  const std::filesystem::path out = folder.path / "out";
  std::filesystem::create_directories(out / "frames");
  std::ofstream(out / "run.json") << R"({"ended":"running","command":["supple","render","x"]})";
  for (const char* frame : {"000000.png", "000001.png", "000003.png"}) std::ofstream(out / "frames" / frame) << "x";
  const Result result = run(folder.path, {"info", "out"});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_lines(result.out, {"ended           not yet, or the run was killed\n",
                            "frames          0 in profile.json, 2 pictures\n", "    frames/ ", "3 bytes  3 files\n"});
  std::ofstream(out / "run.json") << "{}\n";  // as a run starts
  EXPECT_EQ(run(folder.path, {"info", "out"}).status, 0);
}

TEST(Info, TellsOfASurfaceTheVolumeThatBecomesABody) {
  const test::TemporaryFolder folder;
  const Vec3 half(0.5, 0.5, 0.5);
  std::ofstream(folder.path / "nested.obj")
      << test::obj_text(test::together(test::box_surface(half), test::box_surface(0.6 * half)));
  const Result result = run(folder.path, {"info", "nested.obj"});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_lines(result.out, {"piece 1         1 x 1 x 1, volume 1, 24 triangles\n"});
  EXPECT_EQ(result.out.find("cloth"), std::string::npos) << result.out;
}

TEST(Info, TellsOfAnOpenSurfaceThatItCanBeCloth) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "sheet.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  TriMesh tent = test::box_surface(Vec3(0.5, 0.5, 0.5));
  tent.triangles.conservativeResize(10, 3);
  std::ofstream(folder.path / "tent.obj") << test::obj_text(tent);
  const Result sheet = run(folder.path, {"info", "sheet.obj"});
  EXPECT_EQ(sheet.status, 2);
  expect_lines(sheet.err, {"cloth = { surface = \"sheet.obj\" }"});
  const Result open = run(folder.path, {"info", "tent.obj"});
  ASSERT_EQ(open.status, 0) << open.err;
  expect_lines(open.out, {"cloth           ", "cloth = { surface = \"tent.obj\" }\n"});
}

// A lattice as fine as the volume of these asks for would take gigabytes and minutes.
TEST(Info, TellsInLittleRoomOfSurfacesThatFillNextToNothingOfTheirBox) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "thin.obj") << test::obj_text(test::box_surface(Vec3(0.5, 0.5, 5e-10)));
  TriMesh spike = test::box_surface(Vec3(0.5, 0.5, 0.5)), fin = spike;
  spike.points.row(7) << 1000, 1000, 1000;
  fin.points.conservativeResize(9, 3);
  fin.points.row(8) << 1000, 1000, 1000;
  fin.triangles.conservativeResize(13, 3);
  fin.triangles.row(12) << 0, 1, 8;
  TriMesh torn = fin;
  torn.triangles.conservativeResize(12, 3);
  torn.triangles(3, 2) = 8;
  std::ofstream(folder.path / "spike.obj") << test::obj_text(spike);
  std::ofstream(folder.path / "fin.obj") << test::obj_text(fin);
  std::ofstream(folder.path / "torn.obj") << test::obj_text(torn);
  for (const char* name : {"thin.obj", "spike.obj", "fin.obj", "torn.obj"}) {
    const Result result = run(folder.path, {"info", name});
    EXPECT_TRUE(result.status == 0 || (result.status == 2 && !result.err.empty())) << name << ": " << result.err;
    if (std::string(name) == "spike.obj")
      expect_lines(result.err,
                   {"fills so little of its box that lattices of more than 4 million cells would be needed"});
    if (std::string(name) == "thin.obj") expect_lines(result.out, {"volume 1e-09", "thickness     1e-09"});
  }
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  EXPECT_LT(used.ru_maxrss, 2'000'000);  // kB
}

TEST(Info, ReadsScenesAndReplaysWithAByteOrderMark) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "bar.toml") << "\xef\xbb\xbf" << bar_scene;
  std::ofstream(folder.path / "r.toml") << "\xef\xbb\xbf"
                                        << "scene = \"bar.toml\"\n[[change]]\nt = 0.1\npath = \"gravity\"\n"
                                           "value = [0, 0, 0]\n";
  EXPECT_EQ(run(folder.path, {"info", "bar.toml"}).status, 0);
  const Result result = run(folder.path, {"info", "r.toml"});
  EXPECT_EQ(result.status, 0) << result.err;
  expect_lines(result.out, {"changes         1 while it runs\n"});
}

TEST(Info, TellsOfAMeshAndRefusesTheRest) {
  const test::TemporaryFolder folder;
  const Result result = run(folder.path, {"mesh", "sphere", "-o", "s.mesh", "--vertices", "100"});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_lines(run(folder.path, {"info", "s.mesh"}).out,
               {"vertices        ", "dihedral angles ", "boundary        manifold"});
  EXPECT_EQ(run(folder.path, {"info", "none"}).err, "none: no such file\n");
  EXPECT_EQ(run(folder.path, {"info", "squirel"}).err, "squirel: no such file; did you mean 'squirrel'?\n");
  std::filesystem::create_directories(folder.path / "out" / "squirrel");
  std::filesystem::create_directories(folder.path / "out" / "squirrels-notes");
  std::ofstream(folder.path / "out" / "squirrel" / "run.json") << "{}";
  EXPECT_EQ(run(folder.path, {"info", "out/squirel"}).err,
            "out/squirel: no such folder; did you mean 'out/squirrel'?\n");
  EXPECT_EQ(run(folder.path / "out", {"info", "squirrl"}).err, "squirrl: no such folder; did you mean 'squirrel'?\n");
  std::ofstream(folder.path / "out" / "heavy.toml") << bar_scene;
  EXPECT_EQ(run(folder.path, {"info", "out/heavi.toml"}).err,
            "out/heavi.toml: no such file; did you mean 'out/heavy.toml'?\n");
  EXPECT_EQ(run(folder.path, {"info", "none.toml"}).status, 2);
  EXPECT_EQ(run(folder.path, {"info", "none.mesh"}).status, 2);
  std::filesystem::create_directory(folder.path / "empty");
  EXPECT_EQ(run(folder.path, {"info", "empty"}).status, 2);
}

}  // namespace info_test
}  // namespace supple
