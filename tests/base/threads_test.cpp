#include "base/threads.h"

#include <gtest/gtest.h>

#include <thread>

#include "base/queue.h"
#include "base/text.h"

namespace supple {
namespace threads_test {

TEST(Threads, RunEveryChunkOnceHoweverOftenTheyAreAsked) {
  for (const int count : {1, 2, 4}) {
    Threads threads(count);
    for (int round = 0; round < 2000; ++round) {
      std::vector<int> runs(17, 0);
      threads.run(17, [&](int chunk) { ++runs[chunk]; });
      for (const int times : runs) ASSERT_EQ(times, 1);
    }
  }
}

TEST(Threads, ServeAChunkThatAsksForThemItself) {
  Threads threads(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> runs(3 * 17, 0);
    threads.run(3, [&](int outer) { threads.run(17, [&](int inner) { ++runs[17 * outer + inner]; }); });
    for (const int times : runs) ASSERT_EQ(times, 1);
  }
}

TEST(BoundedQueue, GivesItemsInOrderAndEndsWhenItIsClosed) {
  BoundedQueue<int> queue(2);
  std::thread producer([&] {
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(queue.push(i));
    queue.close();
  });
  for (int i = 0; i < 100; ++i) EXPECT_EQ(queue.pop(), i);
  EXPECT_FALSE(queue.pop().has_value());
  producer.join();
  EXPECT_FALSE(queue.push(1));
}

TEST(Text, FindsTheWordThatWasMeant) {
  const std::vector<std::string> words = {"mu", "lambda", "iterations", "history"};
  EXPECT_EQ(nearest_word("iteratons", words), "iterations");
  EXPECT_EQ(nearest_word("lamda", words), "lambda");
  EXPECT_EQ(nearest_word("frobnicate", words), "");
  EXPECT_EQ(word_list({"a", "b", "c"}), "a, b or c");
}

}  // namespace threads_test
}  // namespace supple
