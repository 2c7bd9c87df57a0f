// Tests what is kept in the user's cache, and that a broken cache harms nobody.
#include "base/user_cache.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "support/bodies.h"

namespace supple {
namespace user_cache_test {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

TEST(UserCache, FindsWhatWasKeptUnderTheSameNameOnly) {
  const test::TemporaryFolder folder;
  const UserCache cache(folder.path / "a" / "b", 1000000);
  EXPECT_EQ(cache.find("mesh 1"), std::nullopt);
  cache.keep("mesh 1", std::string("bytes\0and more", 14));
  cache.keep("mesh 2", "");
  EXPECT_EQ(cache.find("mesh 1"), std::string("bytes\0and more", 14));
  EXPECT_EQ(cache.find("mesh 2"), "");
  EXPECT_EQ(cache.find("mesh"), std::nullopt);
  cache.keep("mesh 1", "newer");
  EXPECT_EQ(cache.find("mesh 1"), "newer");
  EXPECT_EQ(UserCache(folder.path / "a" / "b", 1000000).find("mesh 1"), "newer");
  EXPECT_EQ(files_in(folder.path / "a" / "b").size(), 2u);
}

TEST(UserCache, TakesNoDamagedEntry) {
  const test::TemporaryFolder folder;
  const UserCache cache(folder.path, 1000000);
  cache.keep("mesh", std::string(300, 'x'));
  const fs::path file = files_in(folder.path).front();
  const std::string whole = test::read_file(file);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    std::ofstream(file, std::ios::binary) << damaged;
    EXPECT_EQ(cache.find("mesh"), std::nullopt) << "byte " << at;
    std::ofstream(file, std::ios::binary) << whole.substr(0, at);
    EXPECT_EQ(cache.find("mesh"), std::nullopt) << at << " bytes";
  }
  std::ofstream(file, std::ios::binary) << whole << "x";
  EXPECT_EQ(cache.find("mesh"), std::nullopt);
  cache.keep("mesh", "whole again");
  EXPECT_EQ(cache.find("mesh"), "whole again");
}

TEST(UserCache, DropsWhatWasNotUsedForLongest) {
  const test::TemporaryFolder folder;
  const UserCache cache(folder.path, 4000);
  const std::string content(1200, 'x');
  const auto pause = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); };
  for (const char* name : {"first", "second", "third"}) {
    cache.keep(name, content);
    pause();
  }
  EXPECT_LE(cache.used_bytes(), 4000u);
  EXPECT_EQ(cache.find("first"), content);  // and so the second one is the oldest
  pause();
  cache.keep("fourth", content);
  EXPECT_EQ(cache.find("second"), std::nullopt);
  for (const char* name : {"first", "third", "fourth"}) EXPECT_EQ(cache.find(name), content) << name;
  cache.keep("large", std::string(2500, 'x'));  // would leave room for nothing else
  EXPECT_EQ(cache.find("large"), std::nullopt);
  EXPECT_EQ(cache.find("fourth"), content);
}

TEST(UserCache, KeepsNothingWhereItCannotWrite) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "file") << "no folder";
  const UserCache cache(folder.path / "file" / "supple", 1000000);
  cache.keep("mesh", "content");
  EXPECT_EQ(cache.find("mesh"), std::nullopt);
  const UserCache none;
  none.keep("mesh", "content");
  EXPECT_EQ(none.find("mesh"), std::nullopt);
}

TEST(UserCache, LetsThreadsKeepOneNameAtTheSameTime) {
  const test::TemporaryFolder folder;
  const UserCache cache(folder.path, 100000000);
  const auto content = [](int number) { return std::string(100000, static_cast<char>('a' + number)); };
  std::vector<std::thread> threads;
  std::array<int, 4> broken = {};
  for (int number = 0; number < 4; ++number) {
    threads.emplace_back([&, number] {
      for (int round = 0; round < 50; ++round) {
        cache.keep("mesh", content(number));
        const auto found = cache.find("mesh");
        broken[std::size_t(number)] += !found || *found != content(found->front() - 'a') ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(broken, (std::array<int, 4>{}));
  EXPECT_EQ(files_in(folder.path).size(), 1u);
}

// The value of a variable of the environment, put back at the end.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    value == nullptr ? unsetenv(name) : setenv(name, value, 1);
  }
  ~Variable() { before_ ? setenv(name_, before_->c_str(), 1) : unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(UserCache, LiesWhereTheUserWantsIt) {
  const auto folder = [](const char* caches, const char* home) {
    const Variable first("XDG_CACHE_HOME", caches), second("HOME", home);
    return UserCache::of_user().folder();
  };
  EXPECT_EQ(folder("/caches", "/users/me"), "/caches/supple");
  EXPECT_EQ(folder(nullptr, "/users/me"), "/users/me/.cache/supple");
  EXPECT_EQ(folder("relative", "/users/me"), "/users/me/.cache/supple");
  EXPECT_EQ(folder("", "/users/me"), "/users/me/.cache/supple");
  EXPECT_EQ(folder(nullptr, nullptr), "");
  EXPECT_EQ(folder(nullptr, ""), "");
}

}  // namespace user_cache_test
}  // namespace supple
