#include "geometry/files/reader_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <vector>

#include "base/error.h"

extern char** environ;

namespace supple {
namespace {

using Clock = std::chrono::steady_clock;

// Owns a running child and the pipe from its standard output; both end when the object is destroyed.
class Child {
 public:
  // The child is started by posix_spawn, because a fork would copy a process with threads and a GL context only in
  // part.
  Child(const std::filesystem::path& program, const std::string& mode, const std::filesystem::path& file) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) refuse_start(program, file, errno);
    output_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    // The child has a process group of its own: Ctrl-C on the terminal is meant for the parent and must not look like a
    // crash of the reader.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::string words[] = {program.string(), mode.empty() ? file.string() : mode, file.string()};
    char* arguments[] = {words[0].data(), words[1].data(), mode.empty() ? nullptr : words[2].data(), nullptr};
    const int error = ::posix_spawn(&id_, arguments[0], &actions, &attributes, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    ::close(ends[1]);
    if (error == 0) return;
    ::close(output_);
    refuse_start(program, file, error);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    ::close(output_);
    if (id_ <= 0) return;
    ::kill(id_, SIGKILL);
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
  }

  int output() const { return output_; }

  // Returns the status that waitpid gives, or -1 when the child is still running at the deadline.
  int wait_until(Clock::time_point deadline) {
    for (;;) {
      int status = 0;
      const pid_t ended = ::waitpid(id_, &status, WNOHANG);
      if (ended == id_ || (ended < 0 && errno != EINTR)) {
        id_ = 0;
        return status;
      }
      if (Clock::now() >= deadline) return -1;
      ::poll(nullptr, 0, 1);
    }
  }

 private:
  [[noreturn]] static void refuse_start(const std::filesystem::path& program, const std::filesystem::path& file,
                                        int error) {
    throw InputError(file.string(), fmt::format("cannot be read: {}: {}", program.string(), std::strerror(error)));
  }

  pid_t id_ = 0;
  int output_ = -1;
};

void check_status(int status, const std::string& name) {
  if (WIFSIGNALED(status)) {
    if (WTERMSIG(status) == SIGXCPU)
      throw InputError(name, "takes too long to read: its reader may compute for 3 s, and 2 s for each MB of the file");
    if (WTERMSIG(status) == SIGKILL) throw InputError(name, "cannot be read: its reader was killed; is memory short?");
    throw InputError(name, fmt::format("is broken: its reader crashed (signal {})", WTERMSIG(status)));
  }
  if (WEXITSTATUS(status) != 0)
    throw InputError(name, fmt::format("is broken: its reader failed (status {})", WEXITSTATUS(status)));
}

}  // namespace

std::string run_reader(const std::filesystem::path& program, const std::filesystem::path& file,
                       const ReaderLimits& limits, const std::string& mode) {
  const std::string name = file.string(),
                    too_long = fmt::format("takes too long to read: more than {:.3g} s", limits.seconds);
  const Clock::time_point deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limits.seconds));
  Child child(program, mode, file);
  std::string bytes;
  std::vector<char> buffer(1 << 16);
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) throw InputError(name, too_long);
    pollfd ready{child.output(), POLLIN, 0};
    if (::poll(&ready, 1, int(std::min<long long>(left, 1000))) <= 0) continue;
    const ssize_t count = ::read(child.output(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    if (bytes.size() + std::size_t(count) > limits.bytes)
      throw InputError(name, fmt::format("holds more than {} MB of triangles", limits.bytes >> 20));
    bytes.append(buffer.data(), std::size_t(count));
  }
  const int status = child.wait_until(deadline);
  if (status == -1) throw InputError(name, too_long);
  check_status(status, name);
  return bytes;
}

}  // namespace supple
