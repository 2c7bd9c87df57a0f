// A small pool runs numbered chunks of work. The caller fixes the chunks, never the number of threads, and each chunk
// writes only its own output, so the same bits come out however many threads take part. Waiting threads sleep. The
// calling thread takes chunks itself, and a worker that wakes late finds nothing to do; a core that another process
// occupies therefore costs a little time but holds up no barrier. A chunk that asks for threads itself does that work
// alone.
#pragma once

#include <memory>

namespace supple {

class Threads {
 public:
  // count: the number of threads that take part, including the caller; at least 1.
  explicit Threads(int count = 1);
  ~Threads();
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  int count() const { return count_; }

  // Calls body(chunk) once for each chunk in [0, chunks) and returns when all are done. body must not throw. Nothing is
  // allocated.
  template <class Body>
  void run(int chunks, const Body& body) {
    if (chunks <= 0) return;
    if (count_ == 1 || chunks == 1 || is_in_chunk()) {
      for (int chunk = 0; chunk < chunks; ++chunk) body(chunk);
      return;
    }
    run_shared(
        chunks, [](const void* context, int chunk) { (*static_cast<const Body*>(context))(chunk); }, &body);
  }

 private:
  using Call = void (*)(const void* context, int chunk);

  void run_shared(int chunks, Call call, const void* context);
  static bool is_in_chunk();  // whether the calling thread is in a chunk that is shared

  class Workers;  // in threads.cpp, which alone compiles the library's headers for threads
  int count_;
  std::unique_ptr<Workers> workers_;
};

// Runs chunks on threads where there is enough work to be worth waking them. threads: the threads to use; null for the
// calling one alone. work: a rough count of operations.
template <class Body>
void run_chunks(Threads* threads, int chunks, long work, const Body& body) {
  constexpr long worth_sharing = 40000;  // of the order of 20 microseconds; below, waking a thread costs as much
  if (threads != nullptr && work > worth_sharing) {
    threads->run(chunks, body);
  } else {
    for (int chunk = 0; chunk < chunks; ++chunk) body(chunk);
  }
}

}  // namespace supple
