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
  std::string_view method, path;  // of the path what stands before '?'
  std::string_view host, origin;  // headers
  std::string_view length;        // header Content-Length
  std::string_view writer;        // X-Writer, or `writer` of the query
  std::string_view after;         // of the query
};

// Names what there is to ask for.
enum class Door { page, style, script, icon, picture, events, claim, act, replay };

constexpr std::size_t most_bytes = 4096;  // of a request's body

Answer refusal_of(int status, const std::string& text);

// Makes 128 random bits as 32 digits, from the system's source. Throws RunError where it gives none.
std::string random_token();

class Gate {
 public:
  // token: the secret of the URL. listens_to_all: whether the server can be reached from elsewhere, by any numeric
  // address, and not through the loopback alone.
  Gate(std::string token, bool listens_to_all) : token_(std::move(token)), listens_to_all_(listens_to_all) {}

  // Returns what the request asks for, or why it is refused. A page elsewhere cannot pass: a name that leads here by a
  // trick of its name server is no name of this host, and its scripts say where they come from.
  std::variant<Door, Answer> admit(const LiveRequest& request) const;
  const std::string& token() const { return token_; }

 private:
  bool is_own_host(std::string_view host) const;

  std::string token_;
  bool listens_to_all_;
};

// Knows which page steers. One that has gone is forgotten after a while.
class Steering {
 public:
  using Clock = std::chrono::steady_clock;

  // Returns the key of the page that may steer from now on; nothing where another one does.
  std::optional<std::string> claim(Clock::time_point now);
  bool is_writer(std::string_view key) const;
  // The page that steers keeps a stream of events open.
  void connected(std::string_view key);
  // Returns whether nobody steers any more, unless the page comes back.
  bool disconnected(std::string_view key, Clock::time_point now);
  // Counts a command. Returns false where there are too many in a short time.
  bool allows_command(Clock::time_point now);

 private:
  mutable std::mutex mutex_;
  std::string key_;  // empty: nobody steers
  int connections_ = 0;
  Clock::time_point alone_since_;  // without a connection
  double allowed_ = 0;             // commands, as time has added them
  Clock::time_point counted_at_;
};

}  // namespace supple
