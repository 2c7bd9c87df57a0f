// Tests what a replay holds of the live session that wrote it.
#include <gtest/gtest.h>

#include "scene/config/config.h"
#include "scene/replay/played_session.h"
#include "support/played_world.h"

namespace supple {
namespace played_session_test {

const std::string replay = R"(scene = "bunny"
frames = 3
)";

std::string refusal(const std::string& session) {
  try {
    (void)Script::load(SceneSource("replay.toml", replay + session), test::assets, {});
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(PlayedSession, IsReadAsItWasWritten) {
  PlayedSession session;
  session.hashes = {0, 0x0123456789abcdef, ~std::uint64_t(0)};
  session.cuts = {{"a body", 1, 0, {{3, -1}}}, {"a body", 1, 1, {{4, 2}}}, {"other", 2, 0, {{-1, -1}}}};
  Config document = Config::parse(replay, "replay.toml", test::assets);
  put_session(document, session);
  Config written = Config::parse(document.as_toml(), "replay.toml", test::assets);
  const PlayedSession read = read_session(written.root());
  EXPECT_EQ(read.hashes, session.hashes);
  ASSERT_EQ(read.cuts.size(), 3u);
  EXPECT_EQ(read.cuts[1].body, "a body");
  EXPECT_EQ(read.cuts[1].frame, 1);
  EXPECT_EQ(read.cuts[1].substep, 1);
  EXPECT_EQ(read.cuts[1].cuts, (BudgetCuts{{4, 2}}));
  EXPECT_EQ(read.cuts[2].body, "other");
  put_session(document, {});
  EXPECT_EQ(document.as_toml().find("session"), std::string::npos);
}

TEST(PlayedSession, WhatIsWrongIsRefusedWithItsPlace) {
  EXPECT_EQ(refusal("[session]\nhashes = [\"0000000000000000\"]\n"), "");
  EXPECT_EQ(refusal("[session]\nhashes = [\"0g\"]\n"),
            "replay.toml:4:10: hashes: \"0g\" is no hash, which has 16 digits 0 to 9 and a to f");
  EXPECT_NE(refusal("[session]\nhashes = [\"00000000000000000\"]\n").find("is no hash"), std::string::npos);
  EXPECT_NE(refusal("[session]\nhashes = 3\n").find("list of hashes"), std::string::npos);
  EXPECT_NE(refusal("[session]\nhash = []\n").find("unknown key 'hash'"), std::string::npos);
  EXPECT_NE(refusal("[[session.cuts]]\nbody = \"bunny\"\nafter = [1, 2, 3]\n").find("3 numbers; each step has 4"),
            std::string::npos);
}

}  // namespace played_session_test
}  // namespace supple
