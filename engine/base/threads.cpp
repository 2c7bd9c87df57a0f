#include "base/threads.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "base/signals.h"
#include "base/trace.h"

namespace supple {
namespace {

thread_local bool in_chunk = false;

}  // namespace

class Threads::Workers {
 public:
  explicit Workers(int count);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  void run(int chunks, Call call, const void* context);

 private:
  void work(int number);
  void take_chunks(Call call, const void* context, int chunks);

  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable work_ready_;
  std::condition_variable work_done_;
  Call call_ = nullptr;            // the job in progress, guarded by mutex_; null between jobs
  const void* context_ = nullptr;  // the body of that job
  const char* zone_ = nullptr;     // the zone that the job was requested in, for traces
  int chunks_ = 0;
  int running_ = 0;               // number of workers inside the job
  unsigned long generation_ = 0;  // counts jobs, so that a worker enters each at most once
  bool stopping_ = false;
  std::atomic<int> next_chunk_{0};
};

Threads::Workers::Workers(int count) {
  const BlockedSignals meanwhile;  // workers never receive the signals that end the program; the caller does
  for (int i = 1; i <= count; ++i) workers_.emplace_back([this, i] { work(i); });
}

Threads::Workers::~Workers() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  work_ready_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void Threads::Workers::take_chunks(Call call, const void* context, int chunks) {
  in_chunk = true;
  for (int chunk; (chunk = next_chunk_.fetch_add(1, std::memory_order_relaxed)) < chunks;) call(context, chunk);
  in_chunk = false;
}

void Threads::Workers::run(int chunks, Call call, const void* context) {
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

void Threads::Workers::work(int number) {
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

Threads::Threads(int count)
    : count_(std::max(1, count)), workers_(count_ > 1 ? std::make_unique<Workers>(count_ - 1) : nullptr) {}
Threads::~Threads() = default;

bool Threads::is_in_chunk() { return in_chunk; }

void Threads::run_shared(int chunks, Call call, const void* context) { workers_->run(chunks, call, context); }

}  // namespace supple
