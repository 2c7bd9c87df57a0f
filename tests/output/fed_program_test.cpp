// Tests the program that runs at the same time as this one and reads what it is given.
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <csignal>
#include <numeric>
#include <thread>

#include "base/hash.h"
#include "output/files/child_program.h"
#include "support/bodies.h"

namespace supple {
namespace fed_program_test {

const std::vector<std::uint8_t>& three_megabytes() {
  static const std::vector<std::uint8_t> bytes = [] {
    std::vector<std::uint8_t> list(3'000'000);
    std::iota(list.begin(), list.end(), std::uint8_t(0));
    return list;
  }();
  return bytes;
}

TEST(FedProgram, GetsAllBytesInTheirOrder) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path / "copy").string();
  FedProgram program({"sh", "-c", "cat > '" + file + "'; echo done; exit 3"});
  EXPECT_TRUE(program.write(three_megabytes()));
  EXPECT_TRUE(program.write(three_megabytes()));
  const auto end = program.finish();
  ASSERT_TRUE(end);
  EXPECT_EQ(WEXITSTATUS(end->status), 3);
  EXPECT_EQ(end->output, "done\n");
  EXPECT_GT(end->cpu_ms, 0);
  const std::string copy = test::read_file(file), once(three_megabytes().begin(), three_megabytes().end());
  EXPECT_EQ(hash_text(copy), hash_text(once + once));
}

TEST(FedProgram, ThatDiesTakesNoMoreAndSendsNoSignal) {
  FedProgram program({"sh", "-c", "head -c 1000 > /dev/null; kill -9 $$"});
  EXPECT_FALSE(program.write(three_megabytes()));
  EXPECT_FALSE(program.write(three_megabytes()));
  const auto end = program.finish();
  ASSERT_TRUE(end);
  EXPECT_EQ(how_it_ended(*end), "was ended by signal 9");
  sigset_t pending;
  sigpending(&pending);
  EXPECT_EQ(sigismember(&pending, SIGPIPE), 0);
}

TEST(FedProgram, MayTellMoreThanAPipeHolds) {
  FedProgram program({"sh", "-c", "head -c 1000000 /dev/zero | tr '\\0' x; cat > /dev/null; echo end"});
  EXPECT_TRUE(program.write(three_megabytes()));
  const auto end = program.finish();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->output.size(), 4096u);
  EXPECT_TRUE(end->output.ends_with("xend\n"));
}

TEST(FedProgram, ThatIsNotInstalledIsToldFromOneThatFails) {
  FedProgram nowhere({"no-such-program-anywhere"});
  (void)nowhere.write(three_megabytes());
  EXPECT_FALSE(nowhere.finish());
  FedProgram failing({"false"});
  EXPECT_TRUE(failing.finish());
}

// The file would be written if the program continued to run.
TEST(FedProgram, EndsWithItsObjectAndWithTheThreadThatStartedIt) {
  const test::TemporaryFolder folder;
  const auto waiting = [&folder](const char* file) {
    return std::vector<std::string>{"sh", "-c", "cat > /dev/null; echo > '" + (folder.path / file).string() + "'"};
  };
  { const FedProgram dropped(waiting("a")); }
  EXPECT_FALSE(std::filesystem::exists(folder.path / "a"));
  std::optional<FedProgram> program;
  std::thread([&] {
    program.emplace(waiting("b"));
    EXPECT_TRUE(program->write(three_megabytes()));  // so that it runs when this thread ends
  }).join();
  const auto end = program->finish();
  ASSERT_TRUE(end);
  EXPECT_EQ(how_it_ended(*end), "was ended by signal 9");
  EXPECT_FALSE(std::filesystem::exists(folder.path / "b"));
}

}  // namespace fed_program_test
}  // namespace supple
