// Tests who may ask a live session for what.
#include <gtest/gtest.h>

#include "base/error.h"
#include "live/gate.h"

namespace supple {
namespace gate_test {

LiveRequest get(std::string_view path) { return {"GET", path, "127.0.0.1:8000", "", "", "", ""}; }
LiveRequest post(std::string_view path) {
  return {"POST", path, "127.0.0.1:8000", "http://127.0.0.1:8000", "10", "", ""};
}

int status_of(const Gate& gate, const LiveRequest& request) {
  const auto admitted = gate.admit(request);
  const Answer* refusal = std::get_if<Answer>(&admitted);
  return refusal != nullptr ? refusal->status : 200;
}

TEST(LiveGate, RoutesOpenToTheTokenAlone) {
  const Gate gate("0123", Reach::loopback);
  EXPECT_EQ(std::get<Route>(gate.admit(get("/0123/"))), Route::page);
  EXPECT_EQ(std::get<Route>(gate.admit(get("/0123/live.js"))), Route::script);
  EXPECT_EQ(std::get<Route>(gate.admit(get("/0123/events"))), Route::events);
  EXPECT_EQ(std::get<Route>(gate.admit(post("/0123/do"))), Route::act);
  for (const char* path : {"", "/", "//", "/0123", "0123/", "/0124/", "/012/", "/01234/", "/0123x", "/live.js",
                           "/0123/../live.js", "/0123//", "/0123/live.js/", "/0123/etc/passwd", "/0124/events"})
    EXPECT_EQ(status_of(gate, get(path)), 404) << path;
}

TEST(LiveGate, MethodsAreThoseOfTheRoute) {
  const Gate gate("0123", Reach::loopback);
  EXPECT_EQ(status_of(gate, post("/0123/")), 405);
  EXPECT_EQ(status_of(gate, post("/0123/events")), 405);
  EXPECT_EQ(status_of(gate, get("/0123/do")), 405);
  LiveRequest head = get("/0123/");
  head.method = "HEAD";
  EXPECT_EQ(status_of(gate, head), 405);
}

TEST(LiveGate, NamesThatOthersGiveThisHostAreRefused) {
  const Gate near("0123", Reach::loopback), far("0123", Reach::network);
  LiveRequest request = get("/0123/");
  for (const char* own : {"localhost", "localhost:9000", "127.0.0.1", "127.0.0.1:1", "[::1]:8000", "[::1]"}) {
    request.host = own;
    EXPECT_EQ(status_of(near, request), 200) << own;
  }
  for (const char* other : {"", "evil.example", "evil.example:8000", "localhost.evil.example", "127.0.0.1.evil.example",
                            "evil.example:127.0.0.1", "[evil]", "127.0.0.1@evil.example"}) {
    request.host = other;
    EXPECT_EQ(status_of(near, request), 403) << other;
  }
  request.host = "192.168.1.7:8000";
  EXPECT_EQ(status_of(near, request), 403);
  EXPECT_EQ(status_of(far, request), 200);
  request.host = "evil.example";
  EXPECT_EQ(status_of(far, request), 403);
}

TEST(LiveGate, PagesFromElsewhereAreRefused) {
  const Gate gate("0123", Reach::loopback);
  LiveRequest request = post("/0123/do");
  EXPECT_EQ(status_of(gate, request), 200);
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1:8000", "http://127.0.0.1:8001"}) {
    request.origin = origin;
    EXPECT_EQ(status_of(gate, request), 403) << origin;
  }
}

TEST(LiveGate, BodiesThatAreAnnouncedTooLargeAreRefused) {
  const Gate gate("0123", Reach::loopback);
  LiveRequest request = post("/0123/do");
  for (const char* length : {"4097", "1073741824", "99999999999999999999999", "-1", "1e3", "12x"}) {
    request.length = length;
    EXPECT_EQ(status_of(gate, request), 413) << length;
  }
  request.length = "4096";
  EXPECT_EQ(status_of(gate, request), 200);
}

TEST(LiveGate, TokensDiffer) {
  const std::string one = random_token(), two = random_token();
  EXPECT_EQ(one.size(), 32u);
  EXPECT_NE(one, two);
}

using Clock = Steering::Clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Steering, IsOnePages) {
  Steering steering;
  const Clock::time_point start = Clock::now();
  EXPECT_FALSE(steering.is_writer(""));
  const std::string first = steering.claim(start).value();
  EXPECT_TRUE(steering.is_writer(first));
  EXPECT_FALSE(steering.is_writer("x" + first.substr(1)));
  steering.connected(first);
  EXPECT_FALSE(steering.claim(start + seconds(100)));  // as long as it listens
  steering.connected(first);
  EXPECT_FALSE(steering.disconnected(first, start + seconds(100)));  // one of two
  EXPECT_TRUE(steering.disconnected(first, start + seconds(101)));
  EXPECT_FALSE(steering.claim(start + seconds(105)));  // it may only have been loaded again
  const std::string second = steering.claim(start + seconds(107)).value();
  EXPECT_TRUE(steering.is_writer(second));
  EXPECT_FALSE(steering.is_writer(first));
  steering.connected(first);
  EXPECT_FALSE(steering.disconnected(first, start + seconds(108)));
}

TEST(RateLimit, AllowsSoManyASecond) {
  RateLimit limit(300, 200);
  Clock::time_point now = Clock::now();
  int allowed = 0;
  for (int i = 0; i < 1000; ++i) allowed += limit.allows(now) ? 1 : 0;
  EXPECT_EQ(allowed, 200);
  for (int i = 0; i < 1000; ++i) allowed += limit.allows(now += milliseconds(1)) ? 1 : 0;
  EXPECT_NEAR(allowed, 500, 1);
  now += seconds(100);
  allowed = 0;
  for (int i = 0; i < 1000; ++i) allowed += limit.allows(now) ? 1 : 0;
  EXPECT_EQ(allowed, 200);
}

}  // namespace gate_test
}  // namespace supple
