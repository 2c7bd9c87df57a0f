// Tests films of cloth with seams, as a user makes them: a resumed film is the same, and a seam that something holds
// open is named at the end.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/bodies.h"
#include "support/panels.h"
#include "support/program.h"

namespace supple {
namespace seam_film_test {

using test::run;

class SeamFilm : public testing::Test {
 protected:
  void SetUp() override {
    test::write_panels(folder_.path / "panels.obj");
    write("");
  }
  void write(const std::string& more) { std::ofstream(folder_.path / "bag.toml") << test::sewn_panels(more); }
  std::vector<std::string> film(const std::string& out, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"render", "bag.toml", "--no-images", "--quiet", "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  test::TemporaryFolder folder_;
};

TEST_F(SeamFilm, ThatIsResumedWhileItsSeamsCloseIsTheSame) {
  ASSERT_EQ(run(folder_.path, film("whole", {"--frames", "20"})).status, 0);
  ASSERT_EQ(run(folder_.path, film("cut", {"--frames", "7", "--checkpoint-every", "1"})).status, 0);
  const test::Result resumed = run(folder_.path, film("cut", {"--frames", "20", "--resume"}));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(resumed.err.find("a seam of body"), std::string::npos) << resumed.err;
  const auto whole = test::profile_of(folder_.path / "whole"), cut = test::profile_of(folder_.path / "cut");
  for (std::size_t f = 0; f < 20; ++f) {
    const auto &one = whole["frames"][f], &other = cut["frames"][f];
    EXPECT_EQ(one["state_hash"], other["state_hash"]) << f;
    for (const char* key : {"total", "put_in", "from_nothing", "exchanged"})
      EXPECT_EQ(one["bodies"][0]["energy"][key], other["bodies"][0]["energy"][key]) << f;
    EXPECT_LT(one["bodies"][0]["open_seam"], 0.1) << f;
  }
}

TEST_F(SeamFilm, NamesASeamThatStaysOpen) {
  write("[[body.handles]]\nname = \"sides\"\nselect = { box = [[0, 0, 0], [0.01, 1, 1]] }\n");
  const test::Result held = run(folder_.path, film("held", {"--frames", "20"}));
  ASSERT_EQ(held.status, 0) << held.err;
  EXPECT_NE(held.err.find("a seam of body 'bag' is open by"), std::string::npos) << held.err;
  const test::Result check = run(folder_.path, {"check", "bag.toml"}), info = run(folder_.path, {"info", "bag.toml"});
  EXPECT_NE((check.out + check.err).find("2 seams join 18 pairs"), std::string::npos) << check.out << check.err;
  EXPECT_NE(info.out.find("seam            9 pairs, 0.3 m of border with 0.3 m, up to 0.2 m apart"), std::string::npos)
      << info.out;
}

TEST_F(SeamFilm, StatesHoldTheSeamsOfTheirStep) {
  ASSERT_EQ(run(folder_.path, film("states", {"--frames", "3", "--save-state", "2"})).status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_.path / "states" / "states" / "bag-000002" / "seams.npy"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path / "states" / "states" / "bag-000002" / "seam_values.npy"));
}

}  // namespace seam_film_test
}  // namespace supple
