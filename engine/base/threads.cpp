#include "base/threads.h"

#include "base/signals.h"
#include "base/trace.h"

namespace supple {

Threads::Threads(int count) {
  const BlockedSignals meanwhile;  // workers never receive the signals that end the program; the caller does
  for (int i = 1; i < count; ++i) workers_.emplace_back([this, i] { work(i); });
}

Threads::~Threads() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  work_ready_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void Threads::take_chunks(Call call, const void* context, int chunks) {
  for (int chunk; (chunk = next_chunk_.fetch_add(1, std::memory_order_relaxed)) < chunks;) call(context, chunk);
}

void Threads::run_shared(int chunks, Call call, const void* context) {
  {
    const std::lock_guard lock(mutex_);
    next_chunk_.store(0, std::memory_order_relaxed);
    call_ = call;
    context_ = context;
    chunks_ = chunks;
    zone_ = current_zone();
    ++generation_;
  }
  work_ready_.notify_all();
  take_chunks(call, context, chunks);
  const Zone zone("wait for workers");
  std::unique_lock lock(mutex_);
  call_ = nullptr;  // a worker that has not entered the job by now stays out
  work_done_.wait(lock, [this] { return running_ == 0; });
}

void Threads::work(int number) {
  name_thread("worker", number);
  unsigned long seen = 0;
  std::unique_lock lock(mutex_);
  for (;;) {
    work_ready_.wait(lock, [&] { return stopping_ || (call_ != nullptr && generation_ != seen); });
    if (stopping_) return;
    seen = generation_;
    const Call call = call_;
    const void* context = context_;
    const int chunks = chunks_;
    const char* name = zone_;
    ++running_;
    lock.unlock();
    {
      const Zone zone(name);
      take_chunks(call, context, chunks);
    }
    lock.lock();
    if (--running_ == 0) work_done_.notify_one();
  }
}

}  // namespace supple
