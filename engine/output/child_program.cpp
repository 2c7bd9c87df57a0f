#include "output/child_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

extern char** environ;

namespace supple {

namespace {

// Waits until the child has said something or ended, or until it is asked to stop; the last is told.
bool stopped_before_words(int output, pid_t child, const std::function<bool()>& stop) {
  pollfd waited{output, POLLIN, 0};
  do {
    if (!stop()) continue;
    ::kill(child, SIGINT);
    return true;
  } while (::poll(&waited, 1, 100) <= 0);
  return false;
}

}  // namespace

std::optional<ProgramEnd> run_program(const std::vector<std::string>& words, const std::function<bool()>& stop) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  // Ctrl-C on the terminal is ours to handle: an encoder finishes what it has, so a child stands in a process group of
  // its own.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    return std::nullopt;
  }
  ProgramEnd finished{0, ""};
  char buffer[4096];
  for (bool asked = false;;) {
    if (stop && !asked) asked = stopped_before_words(ends[0], child, stop);
    const ssize_t count = ::read(ends[0], buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    finished.output.append(buffer, std::size_t(count));
    if (finished.output.size() > 4096) finished.output.erase(0, finished.output.size() - 4096);
  }
  ::close(ends[0]);
  while (::waitpid(child, &finished.status, 0) < 0 && errno == EINTR) {
  }
  const bool not_found = WIFEXITED(finished.status) && WEXITSTATUS(finished.status) == 127;
  return not_found ? std::nullopt : std::optional(finished);
}

std::string how_it_ended(const ProgramEnd& end) {
  return WIFSIGNALED(end.status) ? fmt::format("was ended by signal {}", WTERMSIG(end.status))
                                 : fmt::format("ended with status {}", WEXITSTATUS(end.status));
}

}  // namespace supple
