// Tests films whose parameters change while they run: every run must give the same bits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "support/bodies.h"
#include "support/program.h"
#include "support/replayed_film.h"

namespace supple {
namespace replay_test {

using test::read_file;
using test::ReplayedFilm;
using test::Result;
using test::run;

TEST_F(ReplayedFilm, GivesTheSameBitsForAnyThreadsWithAndWithoutImages) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--threads", "1", "--out", "a"})).status, 0);
  const std::vector<std::string> expected = hashes("a");
  ASSERT_EQ(expected.size(), 24u);
  for (const char* threads : {"1", "2", "4"}) {
    ASSERT_EQ(run(folder_.path, film({"--no-video", "--threads", threads, "--out", "b"})).status, 0);
    EXPECT_EQ(hashes("b"), expected);
  }
  ASSERT_EQ(run(folder_.path, {"render", "two.toml", "--no-images", "--quiet", "--out", "plain"}).status, 0);
  const std::vector<std::string> plain = hashes("plain");
  EXPECT_TRUE(std::equal(plain.begin(), plain.begin() + 3, expected.begin()));  // the grab is at 0.1 s
  EXPECT_NE(plain[3], expected[3]);
}

TEST_F(ReplayedFilm, IsVerifiedVertexByVertex) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--record", "film.rec"})).status, 0);
  const Result same = run(folder_.path, film({"--no-images", "--verify", "film.rec", "--threads", "1"}));
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_EQ(same.out, "  verified: frames 0 to 23 are the same to the last bit\n");

  // The replay now differs in the last bit of one number: 2e5 and the next double.
  std::string text = read_file(folder_.path / "r.toml");
  text.replace(text.find("value = 2e5"), 11, "value = 200000.00000000003");
  std::ofstream(folder_.path / "r.toml") << text;
  const Result other = run(folder_.path, film({"--no-images", "--verify", "film.rec"}));
  EXPECT_EQ(other.status, 1);
  EXPECT_NE(other.err.find("not the film that was recorded"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("replay.change"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("body 'bar' is not what was recorded; vertex "), std::string::npos) << other.err;
  const std::size_t named = other.err.find("supple: frame ");
  ASSERT_NE(named, std::string::npos);
  const int frame = std::atoi(other.err.c_str() + named + 14);
  EXPECT_GE(frame, 6);  // 0.2 s
  EXPECT_LE(frame, 14);
  const Result near = run(folder_.path, film({"--no-images", "--verify", "film.rec", "--tolerance", "1e-4"}));
  EXPECT_EQ(near.status, 0) << near.err;
  EXPECT_NE(near.out.find("frames 0 to 23 are within 0.0001"), std::string::npos) << near.out;

  std::string record = read_file(folder_.path / "film.rec");
  record.replace(record.find("\"program\":\"") + 11, 4, "0000");
  std::ofstream(folder_.path / "film.rec", std::ios::binary) << record;
  const Result cut = run(folder_.path, film({"--no-images", "--verify", "film.rec", "--record", "film.rec"}));
  EXPECT_EQ(cut.status, 2);
  EXPECT_NE(cut.err.find("would be overwritten"), std::string::npos) << cut.err;
  const Result foreign = run(folder_.path, film({"--no-images", "--verify", "film.rec"}));
  EXPECT_EQ(foreign.status, 2);
  EXPECT_NE(foreign.err.find("was recorded by another build"), std::string::npos) << foreign.err;
  EXPECT_EQ(run(folder_.path, film({"--no-images", "--verify", "two.toml"})).status, 2);
}

TEST_F(ReplayedFilm, RefusesSpringsThatWouldComeOrGo) {
  for (const char* change :
       {"path = \"body.sheet.cloth.bend\"\nvalue = 0", "path = \"body.sheet.cloth.shear\"\nvalue = 0"}) {
    std::ofstream(folder_.path / "bad.toml") << "scene = \"two.toml\"\n[[change]]\nt = 0.3\nover = 0.2\n"
                                             << change << "\n";
    const Result result = run(folder_.path, {"replay", "bad.toml", "--no-images"});
    EXPECT_EQ(result.status, 2) << change;
    EXPECT_NE(result.err.find("cannot reach or leave 0"), std::string::npos) << result.err;
  }
}

TEST_F(ReplayedFilm, ListsAllThatTheBodiesRefuse) {
  std::ofstream(folder_.path / "bad.toml") << R"(scene = "two.toml"
[[change]]
t = 0.3
path = "body.bar.handles.end.stiffness"
value = 30
[[change]]
t = 0.2
path = "body.sheet.cloth.bend"
value = 0
[[change]]
t = 0.4
path = "body.sheet.cloth.stretch"
value = 200
)";
  const Result result = run(folder_.path, {"check", "bad.toml"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err,
            "bad.toml:9:9: shear and bend of the cloth of body 'sheet' cannot reach or leave 0 while the film runs\n"
            "bad.toml:5:9: handle 'end' of body 'bar': hard handles stay hard, and springs stay springs\n");
}

TEST_F(ReplayedFilm, AWholeSolverTableTakesEffectAtOnce) {
  const auto film_with = [&](const std::string& changes) {
    std::ofstream(folder_.path / "s.toml") << "scene = \"two.toml\"\nframes = 10\n" << changes;
    EXPECT_EQ(run(folder_.path, {"replay", "s.toml", "--no-images", "--quiet", "--out", "s"}).status, 0);
    return hashes("s");
  };
  const std::string at = "[[change]]\nframe = 4\npath = \"body.bar.solver";
  EXPECT_EQ(film_with(at + "\"\nvalue = { method = \"newton\", damping = 0.01 }\n"),
            film_with(at + ".method\"\nvalue = \"newton\"\n" + at + ".damping\"\nvalue = 0.01\n"));
}

TEST_F(ReplayedFilm, ACaptionChangesFromItsFrameOn) {
  std::ofstream(folder_.path / "s.toml") << R"(scene = "two.toml"
frames = 6
[[change]]
frame = 2
path = "body.bar.label"
value = "pulled"
[[change]]
frame = 4
path = "body.bar.label"
value = "bar"
)";
  ASSERT_EQ(run(folder_.path, {"replay", "s.toml", "--no-video", "--quiet", "--out", "s"}).status, 0);
  ASSERT_EQ(run(folder_.path, {"render", "two.toml", "--frames", "6", "--no-video", "--quiet", "--out", "p"}).status,
            0);
  EXPECT_EQ(hashes("s"), hashes("p"));
  const std::vector<std::string> changed = pictures("s"), plain = pictures("p");
  for (const std::size_t frame : {0, 1, 4, 5}) EXPECT_EQ(changed[frame], plain[frame]) << frame;
  for (const std::size_t frame : {2, 3}) EXPECT_NE(changed[frame], plain[frame]) << frame;
}

TEST_F(ReplayedFilm, TellsOfImpossibleChangesBeforeTheFilmBegins) {
  std::ofstream(folder_.path / "bad.toml") << R"(scene = "two.toml"
[[change]]
t = 0.3
path = "body.bar.handles.end.stiffness"
value = 30
)";
  const Result result = run(folder_.path, {"replay", "bad.toml", "--no-images"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("hard handles stay hard"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.path / "out"));
}

}  // namespace replay_test
}  // namespace supple
