// Tests films of models with colours: what info says, and that a film drawn again has the same bytes.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "support/bodies.h"
#include "support/colored_files.h"
#include "support/program.h"

namespace supple {
namespace colored_film_test {

std::string bytes_of_file(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

class ColoredFilm : public ::testing::Test {
 protected:
  ColoredFilm() {
    test::write_text(folder_.path / "ball.obj",
                     test::textured_obj(test::textured_ball(0.1, 16, 8), "mtllib ball.mtl\nusemtl skin\n"));
    test::write_text(folder_.path / "ball.mtl", "newmtl skin\nKd 1 0 0\nmap_Kd squares.png\n");
    write_png(folder_.path / "squares.png", 32, 32, test::squares_picture(32, 4));
  }
  test::Result supple(const std::vector<std::string>& words) const { return test::run(folder_.path, words); }
  test::Result film(const std::string& out) const {
    return supple({"render", "ball.obj", "--frames", "3", "--quiet", "--out", out, "--set", "output.width=160", "--set",
                   "output.height=90", "--set", "body.model.vertices=300"});
  }
  std::string frame(const std::string& folder, int number) const {
    return bytes_of_file(folder_.path / folder / "frames" / fmt::format("{:06d}.png", number));
  }
  test::TemporaryFolder folder_;
};

TEST_F(ColoredFilm, DrawnAgainHasTheSameBytes) {
  ASSERT_EQ(film("run").status, 0);
  const test::Result drawn = supple({"draw", "run", "--quiet", "--out", "again"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(frame("run", i), frame("again", i));
  // The colours are seen, and belong to what a film is known by.
  write_png(folder_.path / "squares.png", 32, 32, std::vector<std::uint8_t>(3 * 32 * 32, 200));
  ASSERT_EQ(film("other").status, 0);
  EXPECT_NE(frame("run", 0), frame("other", 0));
  const test::Result resumed =
      supple({"render", "ball.obj", "--frames", "4", "--quiet", "--out", "run", "--resume", "--set", "output.width=160",
              "--set", "output.height=90", "--set", "body.model.vertices=300"});
  EXPECT_EQ(resumed.status, 2) << resumed.err;
  const test::Result skins = supple({"draw", "other", "--skins", "--quiet", "--out", "skins"});
  ASSERT_EQ(skins.status, 0) << skins.err;
  EXPECT_TRUE(std::filesystem::exists(folder_.path / "skins" / "motion" / "model-0.png"));
  EXPECT_NE(bytes_of_file(folder_.path / "skins" / "motion" / "model.obj").find("vt "), std::string::npos);
}

TEST_F(ColoredFilm, WhatIsMissingIsSaid) {
  EXPECT_NE(supple({"info", "ball.obj"}).out.find("colours         1 material, texture 'squares.png' of 32 x 32\n"),
            std::string::npos);
  std::filesystem::remove(folder_.path / "squares.png");
  const test::Result info = supple({"info", "ball.obj"});
  EXPECT_NE(info.out.find("colours         1 material\n"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("note: texture 'squares.png' is missing"), std::string::npos) << info.out;
  test::write_text(folder_.path / "s.toml", "[[body]]\nsurface = \"ball.obj\"\nmaterial = \"jelly\"\nvertices = 300\n");
  const test::Result check = supple({"check", "s.toml"});
  EXPECT_EQ(check.status, 0);
  EXPECT_NE(check.out.find("texture 'squares.png' is missing"), std::string::npos) << check.out;
}

}  // namespace colored_film_test
}  // namespace supple
