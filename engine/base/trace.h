// Zones are named spans of time on every thread, for the profiler. A zone lasts as long as its object and may lie
// inside other zones of its thread. While no trace is recorded, a zone costs one relaxed load and a branch, and
// allocates nothing. While one is recorded, a zone costs two readings of the clock and 64 bytes, which are allocated
// for a few thousand zones at a time. Zones only read the clock: no result can depend on them.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

// Describes a zone that has ended.
struct TraceEvent {
  const char* name;
  std::int64_t begin_ns, end_ns;  // of the steady clock
  std::int32_t depth;             // number of zones of the same thread around this one
  std::int32_t number;            // the frame, or -1
  std::array<char, 32> subject;   // name of the body, cut to fit; ends with a zero
};

struct ThreadTrace {
  std::string name;                // "worker", for example
  int number = 0;                  // 1, 2, ... among threads with the same task; 0 when there is only one
  std::vector<TraceEvent> events;  // ordered by begin; a zone stands before those that lie in it
  long lost = 0;                   // number of zones that were dropped for lack of room
};

// Forgets all zones recorded so far and begins to record.
void start_trace();

// Ends the recording. Returns what was recorded, by thread, in the order in which the threads first had a zone. Zones
// that have not yet ended are left out.
std::vector<ThreadTrace> stop_trace();

// Sets the calling thread's name in traces. name: a literal, or null for no name.
void name_thread(const char* name, int number = 0);

// Returns the name of the calling thread's innermost zone, or "work" when it is in none.
const char* current_zone();

// Tells all threads whether zones are recorded. It is global because zones lie in code of every layer, and no caller
// could pass a recorder down to all of them.
inline std::atomic<bool> trace_is_on{false};

class Zone {
 public:
  // name: must be a literal. subject: must outlive the zone.
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

  // Ends this zone and begins another one in its place, with the same subject and number.
  void next(const char* name) {
    if (name_ == nullptr) [[likely]]
      return;
    end();
    begin(name, subject_, number_);
  }

 private:
  void begin(const char* name, std::string_view subject, int number);
  void end();

  const char* name_ = nullptr;  // null while nothing is recorded
  const char* outer_;           // the name of the zone around this one
  std::string_view subject_;
  std::int64_t begin_ns_;
  int number_;
};

}  // namespace supple
