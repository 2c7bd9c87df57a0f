// Carries commands from the threads that read requests to the thread that makes frames, which takes them between two
// frames and answers each. Neither side ever waits for the other.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "live/command.h"

namespace supple {

// Answers a request: the status of HTTP, and the body as JSON.
struct Answer {
  int status = 200;
  std::string body;
};
using TakesAnswer = std::function<void(Answer)>;

struct Letter {
  Command command;
  std::uint64_t input = 0;  // number of the command, by which a picture tells that it shows its effect
  TakesAnswer answer;       // to be called once, by any thread
};

class Mailbox {
 public:
  // Returns false where too many letters wait, or nobody will take them; the letter is then not answered.
  bool post(Letter letter) {
    const std::lock_guard lock(mutex_);
    if (closed_ || letters_.size() >= most_letters) return false;
    letters_.push_back(std::move(letter));
    arrived_.notify_one();
    return true;
  }
  // Returns all letters that wait, in their order.
  std::vector<Letter> take() {
    const std::lock_guard lock(mutex_);
    std::vector<Letter> taken(std::make_move_iterator(letters_.begin()), std::make_move_iterator(letters_.end()));
    letters_.clear();
    return taken;
  }
  // Waits for a letter, at most until this time.
  void wait_until(std::chrono::steady_clock::time_point time) {
    std::unique_lock lock(mutex_);
    arrived_.wait_until(lock, time, [this] { return !letters_.empty(); });
  }
  // Returns all letters that wait, after which no more are accepted.
  std::vector<Letter> close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    return take();
  }

 private:
  static constexpr std::size_t most_letters = 64;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Letter> letters_;
  bool closed_ = false;
};

}  // namespace supple
