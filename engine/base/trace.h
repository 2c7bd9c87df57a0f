// Zones: named spans of time on every thread, for the profiler. A zone lasts as long as its object and may lie in
// others of its thread. While nothing is traced a zone costs one relaxed load and a branch, and allocates nothing;
// while something is, two looks at the clock and 64 bytes, taken a few thousand zones at a time. Zones only look at the
// clock: no result can depend on them.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

// A zone that has ended.
struct TraceEvent {
  const char* name;
  std::int64_t begin_ns, end_ns;  // of the steady clock
  std::int32_t depth;             // zones of this thread that it lies in
  std::int32_t number;            // the frame, or -1
  std::array<char, 32> subject;   // the body, cut to fit; ends with a zero
};

struct ThreadTrace {
  std::string name;                // "worker"
  int number = 0;                  // 1, 2, ... of threads that do the same; 0 when it is the only one
  std::vector<TraceEvent> events;  // by begin; a zone before those that lie in it
  long lost = 0;                   // zones that found no room
};

// Forgets all zones before, and begins to record.
void start_trace();

// Ends recording. What was recorded, by thread, in the order in which the threads first had a zone. Zones that have not
// ended are not in it.
std::vector<ThreadTrace> stop_trace();

// What the calling thread is called in traces. name: a literal, or null: it has none.
void name_thread(const char* name, int number = 0);

// The innermost zone of the calling thread; "work" when it is in none.
const char* current_zone();

// The only state that every thread looks at: zones lie in code of all layers, which no caller can hand a recorder to.
inline std::atomic<bool> trace_is_on{false};

class Zone {
 public:
  // name: a literal. subject: must outlive the zone.
  explicit Zone(const char* name, std::string_view subject = {}, int number = -1) {
    if (trace_is_on.load(std::memory_order_relaxed)) [[unlikely]]
      begin(name, subject, number);
  }
  ~Zone() { finish(); }
  Zone(const Zone&) = delete;
  Zone& operator=(const Zone&) = delete;

  // Ends the zone before its object ends.
  void finish() {
    if (name_ != nullptr) [[unlikely]]
      end();
  }

  // Ends this zone and begins another one in its place, of the same subject and number.
  void next(const char* name) {
    if (name_ == nullptr) [[likely]]
      return;
    end();
    begin(name, subject_, number_);
  }

 private:
  void begin(const char* name, std::string_view subject, int number);
  void end();

  const char* name_ = nullptr;  // null: not recorded
  const char* outer_;           // the zone around it
  std::string_view subject_;
  std::int64_t begin_ns_;
  int number_;
};

}  // namespace supple
