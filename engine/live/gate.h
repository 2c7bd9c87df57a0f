// Decides what becomes of a request before anything of it is carried out: who may ask, from which page, for what. It
// knows no sockets, so that it can be tried with any text.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "base/names.h"
#include "live/mailbox.h"

namespace supple {

// Holds what the gate reads of a request. Texts are empty where the request does not have them.
struct LiveRequest {
  std::string_view method, path;  // the path is what stands before '?'
  std::string_view host, origin;  // headers
  std::string_view length;        // header Content-Length
  std::string_view writer;        // X-Writer, or `writer` of the query
  std::string_view after;         // of the query
};

// Names what there is to ask for.
enum class Route { page, style, script, icon, picture, events, claim, act, replay };

enum class Reach { loopback, network };
// Returns how far an address in numbers can be reached.
Reach reach_of(std::string_view address);

constexpr std::size_t most_bytes = 4096;  // of a request's body

// Makes 128 random bits as 32 digits, from the system's source. Throws RunError where it gives none.
std::string random_token();

class Gate {
 public:
  // token: the secret of the URL. reach: from where the server can be reached.
  Gate(std::string token, Reach reach) : token_(std::move(token)), reach_(reach) {}

  // Returns what the request asks for, or why it is refused. Pages of other sites cannot pass: a name of theirs that
  // their name server leads to this host (DNS rebinding) is no name of this host, and requests of their scripts say
  // where they come from.
  std::variant<Route, Answer> admit(const LiveRequest& request) const;
  const std::string& token() const { return token_; }

 private:
  bool is_own_host(std::string_view host) const;

  std::string token_;
  Reach reach_;
};

// Counts events, and allows so many in a second, and so many at once after a rest (a token bucket).
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;
  RateLimit(double a_second, double at_once) : a_second_(a_second), at_once_(at_once), allowed_(at_once) {}
  // Counts an event. Returns false where there are too many.
  bool allows(Clock::time_point now);

 private:
  double a_second_, at_once_, allowed_;  // the last: how many are left at counted_at_
  Clock::time_point counted_at_;
};

// Knows which page steers. One that has gone is forgotten after a while.
class Steering {
 public:
  using Clock = std::chrono::steady_clock;

  // Lets the page that asks steer from now on, and returns its key; nothing where another page steers.
  std::optional<std::string> claim(Clock::time_point now);
  bool is_writer(std::string_view key) const;
  // Counts a stream of events that opens. The page that steers keeps one open.
  void connected(std::string_view key);
  // Counts a stream of events that has closed. Returns whether it was the last one of the page that steers: then nobody
  // steers any more, unless the page comes back.
  bool disconnected(std::string_view key, Clock::time_point now);

 private:
  mutable std::mutex mutex_;
  std::string key_;  // empty: nobody steers
  int connections_ = 0;
  Clock::time_point alone_since_;  // without a connection
};

}  // namespace supple
