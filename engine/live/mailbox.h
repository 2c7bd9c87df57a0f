// Carries commands from the threads that read requests to the thread that makes frames, which takes them between two
// frames and answers each. Neither side ever waits for the other.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "live/command.h"

namespace supple {

// Answers a request: the status of HTTP, and the body as JSON.
struct Answer {
  int status = 200;
  std::string body;
};

// Returns an answer that says why a request is refused.
Answer refusal_of(int status, const std::string& text);

// Answers a command once, from any thread. A command that is dropped is answered, too.
class Reply {
 public:
  using Take = std::function<void(Answer)>;
  explicit Reply(Take take) : take_(std::move(take)) {}
  ~Reply() { give(refusal_of(503, "the program has ended, or could not do this")); }
  Reply(const Reply&) = delete;
  Reply& operator=(const Reply&) = delete;
  void give(Answer answer) {
    if (const Take take = std::exchange(take_, nullptr)) take(std::move(answer));
  }

 private:
  Take take_;
};

struct PostedCommand {
  Command command;
  std::uint64_t input = 0;  // number of the command, by which a picture tells that it shows its effect
  std::shared_ptr<Reply> reply;
};

enum class Posted { taken, full, closed };

class Mailbox {
 public:
  // must: whether the command is taken although many wait.
  Posted post(PostedCommand command, bool must = false) {
    const std::lock_guard lock(mutex_);
    if (closed_) return Posted::closed;
    if (commands_.size() >= most_commands && !must) return Posted::full;
    commands_.push_back(std::move(command));
    arrived_.notify_one();
    return Posted::taken;
  }
  // Returns all commands that wait, in their order.
  std::vector<PostedCommand> take() {
    const std::lock_guard lock(mutex_);
    std::vector<PostedCommand> taken(std::make_move_iterator(commands_.begin()),
                                     std::make_move_iterator(commands_.end()));
    commands_.clear();
    return taken;
  }
  // Waits for a command, at most until this time.
  void wait_until(std::chrono::steady_clock::time_point time) {
    std::unique_lock lock(mutex_);
    arrived_.wait_until(lock, time, [this] { return !commands_.empty(); });
  }
  // Accepts no more commands, and drops those that wait.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    take();
  }

 private:
  static constexpr std::size_t most_commands = 64;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<PostedCommand> commands_;
  bool closed_ = false;
};

}  // namespace supple
