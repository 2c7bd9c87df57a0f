// Keeps what pages are told: the last events in a ring, and the newest state of all that a page shows when it is
// opened. Each reader goes through the ring at its own pace; one that falls behind begins anew with the state.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace supple {

class EventLog {
 public:
  // Adds an event. data: JSON in one line.
  void add(const std::string& name, const std::string& data);
  // Adds an event whose newest form is part of what a page is told first.
  void keep(const std::string& name, const std::string& data);
  // Sets a part of what a page is told first, without an event.
  void keep_silently(const std::string& name, const std::string& data);

  // Returns the text of all events after number `seen` as a stream of server-sent events, and moves `seen` on to the
  // last one. A reader that begins (seen: 0), or has missed some, gets one event "hello" in their place: an object of
  // all kept data, with `writer` in it. Empty where there is nothing new.
  std::string text_after(std::uint64_t& seen, bool writer) const;

  // Sets what is called after each event, on the thread that adds it.
  void on_event(std::function<void()> wake);

 private:
  struct Event {
    std::uint64_t number;
    std::string text;
  };
  static constexpr std::size_t most_events = 256;
  mutable std::mutex mutex_;
  std::uint64_t last_ = 1;  // number of the last event
  std::deque<Event> events_;
  std::map<std::string, std::string> kept_;
  std::mutex wake_mutex_;  // held while wake_ runs, so that it is not replaced meanwhile
  std::function<void()> wake_;
};

// Writes an event as the stream has it.
std::string event_text(const std::string& name, const std::string& data);

}  // namespace supple
