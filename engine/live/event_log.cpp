#include "live/event_log.h"

#include <fmt/core.h>

namespace supple {

std::string event_text(const std::string& name, const std::string& data) {
  return fmt::format("event: {}\ndata: {}\n\n", name, data);
}

void EventLog::add(const std::string& name, const std::string& data) {
  {
    const std::lock_guard lock(mutex_);
    events_.push_back({++last_, event_text(name, data)});
    if (events_.size() > most_events) events_.pop_front();
  }
  const std::lock_guard lock(wake_mutex_);
  if (wake_) wake_();
}

void EventLog::keep(const std::string& name, const std::string& data) {
  keep_silently(name, data);
  add(name, data);
}

void EventLog::keep_silently(const std::string& name, const std::string& data) {
  const std::lock_guard lock(mutex_);
  kept_[name] = data;
}

std::string EventLog::text_after(std::uint64_t& seen, bool writer) const {
  const std::lock_guard lock(mutex_);
  if (seen == last_) return "";
  std::string text;
  if (seen == 0 || seen + 1 < (events_.empty() ? last_ : events_.front().number)) {
    text = fmt::format("{{\"writer\":{}", writer);
    for (const auto& [name, data] : kept_) text += fmt::format(",\"{}\":{}", name, data);
    text = event_text("hello", text + "}");
  } else {
    for (const Event& event : events_)
      if (event.number > seen) text += event.text;
  }
  seen = last_;
  return text;
}

void EventLog::on_event(std::function<void()> wake) {
  const std::lock_guard lock(wake_mutex_);
  wake_ = std::move(wake);
}

}  // namespace supple
