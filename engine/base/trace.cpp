#include "base/trace.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <new>
#include <utility>

namespace supple {
namespace {

constexpr std::size_t events_a_chunk = 4096;      // 256 kB
constexpr std::size_t events_a_thread = 1 << 22;  // 256 MB; later events are dropped, and counted

std::int64_t now_ns() {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

struct Chunk {
  std::array<TraceEvent, events_a_chunk> events;
  std::atomic<std::size_t> count{0};  // number of events that may be read
  std::atomic<Chunk*> next{nullptr};
};

// Holds the zones of one thread. Only that thread adds zones; meanwhile, a thread that holds the registry's lock may
// take them out. Neither waits for the other: chunks only grow, and the chunk that is being filled is left to its
// writer.
class Buffer {
 public:
  Buffer(const char* thread_name, int thread_number) : name(thread_name), number(thread_number) {}
  ~Buffer() {
    for (Chunk* chunk = first_ != nullptr ? first_ : entry_.load(); chunk != nullptr;)
      delete std::exchange(chunk, chunk->next.load());
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  void put(const TraceEvent& event) {
    std::size_t at = last_ == nullptr ? events_a_chunk : last_->count.load(std::memory_order_relaxed);
    if (at == events_a_chunk) {
      if (!grow()) {
        lost_.fetch_add(1, std::memory_order_relaxed);
        return;
      }
      at = 0;
    }
    last_->events[at] = event;
    last_->count.store(at + 1, std::memory_order_release);
  }

  // Moves all events that began at `since` or later to `into`.
  void take(std::int64_t since, ThreadTrace& into) {
    Chunk* chunk = first_ != nullptr ? first_ : entry_.load(std::memory_order_acquire);
    while (chunk != nullptr) {
      first_ = chunk;
      const std::size_t count = chunk->count.load(std::memory_order_acquire);
      for (; read_ < count; ++read_) {
        if (chunk->events[read_].begin_ns >= since) into.events.push_back(chunk->events[read_]);
      }
      chunk = chunk->next.load(std::memory_order_acquire);
      if (chunk == nullptr) return;
      delete first_;
      chunks_.fetch_sub(1, std::memory_order_relaxed);
      read_ = 0;
    }
  }
  long take_lost() { return lost_.exchange(0, std::memory_order_relaxed); }

  const char* const name;
  const int number;
  std::atomic<bool> ended{false};  // whether its thread has ended
  bool done = false;               // whether all its events were taken out as well

 private:
  bool grow() {
    if (chunks_.load(std::memory_order_relaxed) == events_a_thread / events_a_chunk) return false;
    auto* chunk = new (std::nothrow) Chunk;
    if (chunk == nullptr) return false;
    chunks_.fetch_add(1, std::memory_order_relaxed);
    (last_ == nullptr ? entry_ : last_->next).store(chunk, std::memory_order_release);
    last_ = chunk;
    return true;
  }

  Chunk* last_ = nullptr;               // the chunk that the writer fills
  std::atomic<Chunk*> entry_{nullptr};  // the very first chunk, where the reader begins
  Chunk* first_ = nullptr;              // the first chunk that the reader has not yet taken as a whole
  std::size_t read_ = 0;                // number of events of first_ that the reader has taken
  std::atomic<std::size_t> chunks_{0};
  std::atomic<long> lost_{0};
};

struct Registry {
  std::mutex mutex;
  std::vector<std::shared_ptr<Buffer>> buffers;
  std::int64_t start_ns = 0;
};

// The registry is never destroyed, because threads may end after static objects.
Registry& registry() {
  static Registry& instance = *new Registry;
  return instance;
}

// Holds what a thread knows of itself. The type is trivial, so that access costs nothing.
struct ThreadState {
  const char* name;
  int number;
  int depth;
  const char* zone;
  Buffer* buffer;
};
constinit thread_local ThreadState self{};

// Holds a thread's ownership of its buffer, which it shares with the registry. When the thread ends, the buffer is
// marked as ended.
struct Share {
  std::shared_ptr<Buffer> buffer;
  ~Share() {
    self.buffer = nullptr;
    if (buffer) buffer->ended.store(true, std::memory_order_release);
  }
};
thread_local Share share;

Buffer& own_buffer() {
  if (self.buffer == nullptr) {
    Registry& all = registry();
    share.buffer = std::make_shared<Buffer>(self.name != nullptr ? self.name : "thread", self.number);
    const std::lock_guard lock(all.mutex);
    all.buffers.push_back(share.buffer);
    self.buffer = share.buffer.get();
  }
  return *self.buffer;
}

}  // namespace

void start_trace() {
  (void)stop_trace();
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  all.start_ns = now_ns();
  trace_is_on.store(true, std::memory_order_relaxed);
}

std::vector<ThreadTrace> stop_trace() {
  trace_is_on.store(false, std::memory_order_relaxed);
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  std::vector<ThreadTrace> threads;
  for (const auto& buffer : all.buffers) {
    const bool ended = buffer->ended.load(std::memory_order_acquire);
    ThreadTrace thread{buffer->name, buffer->number, {}, buffer->take_lost()};
    buffer->take(all.start_ns, thread);
    std::ranges::sort(thread.events, [](const TraceEvent& a, const TraceEvent& b) {
      return a.begin_ns != b.begin_ns ? a.begin_ns < b.begin_ns : a.depth < b.depth;
    });
    if (!thread.events.empty() || thread.lost > 0) threads.push_back(std::move(thread));
    buffer->done = ended;
  }
  std::erase_if(all.buffers, [](const auto& buffer) { return buffer->done; });
  return threads;
}

void name_thread(const char* name, int number) {
  self.name = name;
  self.number = number;
}

const char* current_zone() { return self.zone != nullptr ? self.zone : "work"; }

void Zone::begin(const char* name, std::string_view subject, int number) {
  name_ = name;
  outer_ = self.zone;
  subject_ = subject;
  number_ = number;
  self.zone = name;
  ++self.depth;
  begin_ns_ = now_ns();
}

void Zone::end() {
  const std::int64_t end_ns = now_ns();
  TraceEvent event{name_, begin_ns_, end_ns, --self.depth, number_, {}};
  std::ranges::copy(subject_.substr(0, event.subject.size() - 1), event.subject.begin());
  self.zone = outer_;
  name_ = nullptr;
  own_buffer().put(event);
}

}  // namespace supple
