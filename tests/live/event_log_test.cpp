// Tests what pages are told: everything once and in order, or all that is known where they have missed some.
#include <gtest/gtest.h>

#include "live/event_log.h"

namespace supple {
namespace event_log_test {

TEST(EventLog, BeginsWithWhatIsKnown) {
  EventLog log;
  log.keep_silently("title", "\"A bunny\"");
  log.keep("words", "[]");
  log.add("frame", "{\"frame\":1}");
  log.keep("words", "[\"torn\"]");
  std::uint64_t seen = 0;
  EXPECT_EQ(log.text_after(seen, true),
            "event: hello\ndata: {\"writer\":true,\"title\":\"A bunny\",\"words\":[\"torn\"]}\n\n");
  EXPECT_EQ(log.text_after(seen, true), "");
}

TEST(EventLog, TellsEachEventOnceAndInOrder) {
  EventLog log;
  std::uint64_t seen = 0;
  EXPECT_EQ(log.text_after(seen, false), "event: hello\ndata: {\"writer\":false}\n\n");
  log.add("frame", "1");
  log.add("frame", "2");
  EXPECT_EQ(log.text_after(seen, false), "event: frame\ndata: 1\n\nevent: frame\ndata: 2\n\n");
  log.add("frame", "3");
  EXPECT_EQ(log.text_after(seen, false), "event: frame\ndata: 3\n\n");
  EXPECT_EQ(log.text_after(seen, false), "");
}

TEST(EventLog, AReaderThatFellBehindBeginsAnew) {
  EventLog log;
  std::uint64_t slow = 0, quick = 0;
  (void)log.text_after(slow, false);
  (void)log.text_after(quick, false);
  for (int i = 0; i < 256; ++i) log.add("frame", "0");
  EXPECT_TRUE(log.text_after(quick, false).starts_with("event: frame"));
  log.add("frame", "0");
  EXPECT_EQ(log.text_after(slow, false), "event: hello\ndata: {\"writer\":false}\n\n");
  EXPECT_EQ(log.text_after(quick, false), "event: frame\ndata: 0\n\n");
}

TEST(EventLog, WakesWhoListens) {
  EventLog log;
  int woken = 0;
  log.on_event([&woken] { ++woken; });
  log.add("frame", "0");
  log.keep("state", "{}");
  log.keep_silently("controls", "[]");
  EXPECT_EQ(woken, 2);
  log.on_event(nullptr);
  log.add("frame", "0");
  EXPECT_EQ(woken, 2);
}

}  // namespace event_log_test
}  // namespace supple
