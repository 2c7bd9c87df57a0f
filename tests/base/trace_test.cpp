#include "base/trace.h"

#include <gtest/gtest.h>

#include <thread>

#include "base/threads.h"
#include "support/allocation_counter.h"

namespace supple {
namespace trace_test {

const ThreadTrace* thread_named(const std::vector<ThreadTrace>& threads, const std::string& name, int number = 0) {
  for (const ThreadTrace& thread : threads) {
    if (thread.name == name && thread.number == number) return &thread;
  }
  return nullptr;
}

TEST(Trace, ZonesNestAsTheirObjectsDo) {
  name_thread("main");
  start_trace();
  {
    const Zone frame("frame", {}, 7);
    Zone part("first", "a body whose name is longer than thirty-one letters");
    { const Zone inner("inner"); }
    part.next("second");
    part.finish();
    EXPECT_STREQ(current_zone(), "frame");
  }
  const std::vector<ThreadTrace> threads = stop_trace();
  const ThreadTrace* thread = thread_named(threads, "main");
  ASSERT_NE(thread, nullptr);
  ASSERT_EQ(thread->events.size(), 4u);
  const char* names[] = {"frame", "first", "inner", "second"};
  const int depths[] = {0, 1, 2, 1};
  for (int i = 0; i < 4; ++i) {
    EXPECT_STREQ(thread->events[i].name, names[i]);
    EXPECT_EQ(thread->events[i].depth, depths[i]);
    EXPECT_LE(thread->events[i].begin_ns, thread->events[i].end_ns);
    EXPECT_GE(thread->events[i].begin_ns, thread->events[0].begin_ns);
    EXPECT_LE(thread->events[i].end_ns, thread->events[0].end_ns);
  }
  EXPECT_LE(thread->events[1].end_ns, thread->events[3].begin_ns);
  EXPECT_EQ(thread->events[0].number, 7);
  EXPECT_EQ(thread->events[1].number, -1);
  EXPECT_STREQ(thread->events[1].subject.data(), "a body whose name is longer tha");
  EXPECT_STREQ(thread->events[3].subject.data(), thread->events[1].subject.data());
  EXPECT_EQ(thread->lost, 0);
}

TEST(Trace, RecordsAndAllocatesNothingWhileItIsOff) {
  (void)stop_trace();
  const std::string body = "body";
  const long before = test::allocations();
  for (int i = 0; i < 10000; ++i) {
    Zone zone("zone", body, i);
    zone.next("other");
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_STREQ(current_zone(), "work");
  start_trace();
  EXPECT_TRUE(stop_trace().empty());
}

TEST(Trace, KeepsWhatBeganWhileItWasOnAndNothingElse) {
  {
    const Zone before("before");
    start_trace();
    const Zone inside("inside");
  }
  std::vector<ThreadTrace> threads = stop_trace();
  ASSERT_EQ(threads.size(), 1u);
  ASSERT_EQ(threads[0].events.size(), 1u);
  EXPECT_STREQ(threads[0].events[0].name, "inside");
  {
    start_trace();
    const Zone open("open");
    EXPECT_TRUE(stop_trace().empty());
  }
  start_trace();  // zones that end after the last trace are not in this one
  { const Zone zone("zone"); }
  threads = stop_trace();
  ASSERT_EQ(threads.size(), 1u);
  EXPECT_EQ(threads[0].events.size(), 1u);
}

TEST(Trace, TakesEveryZoneOfEveryThreadAlsoOfThoseThatHaveEnded) {
  constexpr int zones = 10000;  // more than one chunk of events
  start_trace();
  std::vector<std::thread> threads;
  for (int t = 1; t <= 3; ++t) {
    threads.emplace_back([t] {
      name_thread("counter", t);
      for (int i = 0; i < zones; ++i) const Zone zone("count", {}, i);
    });
  }
  for (std::thread& thread : threads) thread.join();
  const std::vector<ThreadTrace> traces = stop_trace();
  ASSERT_EQ(traces.size(), 3u);
  for (int t = 1; t <= 3; ++t) {
    const ThreadTrace* trace = thread_named(traces, "counter", t);
    ASSERT_NE(trace, nullptr);
    ASSERT_EQ(trace->events.size(), std::size_t(zones));
    for (int i = 0; i < zones; ++i) ASSERT_EQ(trace->events[i].number, i);
  }
  start_trace();
  EXPECT_TRUE(stop_trace().empty());
}

TEST(Trace, CanBeStoppedWhileOthersAreBusy) {
  std::atomic<bool> done{false};
  std::thread busy([&done] {
    while (!done.load()) {
      const Zone zone("zone");
      const Zone inner("inner");
    }
  });
  std::size_t seen = 0;
  while (seen < 50000) {
    start_trace();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (const ThreadTrace& thread : stop_trace()) {
      for (const TraceEvent& event : thread.events) ASSERT_LE(event.begin_ns, event.end_ns);
      seen += thread.events.size();
    }
  }
  done = true;
  busy.join();
}

TEST(Trace, WorkersSayForWhichZoneTheyWork) {
  start_trace();
  {
    Threads threads(2);
    const Zone zone("evaluate");
    std::atomic<int> inside{0};
    // Neither of the two chunks ends before both have begun, so one of them is the worker's.
    threads.run(2, [&](int) {
      ++inside;
      while (inside.load() < 2) std::this_thread::yield();
    });
  }
  const std::vector<ThreadTrace> traces = stop_trace();
  const ThreadTrace* worker = thread_named(traces, "worker", 1);
  ASSERT_NE(worker, nullptr);
  ASSERT_EQ(worker->events.size(), 1u);
  EXPECT_STREQ(worker->events[0].name, "evaluate");
}

}  // namespace trace_test
}  // namespace supple
