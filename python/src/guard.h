// Keeps an object from being used by a second thread while it is at work in one, and by a process that inherited it.
#pragma once

#include <unistd.h>

#include <mutex>
#include <stdexcept>

namespace supple::python {

class Busy {
 public:
  // Holds the object while it lives. Throws std::runtime_error where the object cannot be used.
  class Use {
   public:
    explicit Use(Busy& busy) : lock_(busy.mutex_, std::try_to_lock) {
      if (!lock_.owns_lock())
        throw std::runtime_error(
            "this object is at work already, in another thread or in the call that this one interrupts");
      if (getpid() != busy.process_)
        throw std::runtime_error(
            "this object was made in another process, whose threads were not inherited: make it anew here");
    }

   private:
    std::unique_lock<std::mutex> lock_;
  };

 private:
  std::mutex mutex_;
  pid_t process_ = getpid();
};

}  // namespace supple::python
