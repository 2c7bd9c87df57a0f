#include "output/child_program.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

namespace supple {

namespace {

// Waits until the child has written something or ended, or until it is asked to stop. Returns whether it was asked to
// stop.
bool stopped_before_output(int output, pid_t child, const std::function<bool()>& stop) {
  pollfd waited{output, POLLIN, 0};
  do {
    if (!stop()) continue;
    ::kill(child, SIGINT);
    return true;
  } while (::poll(&waited, 1, 100) <= 0);
  return false;
}

constexpr int cannot_start = 127;

// Runs in the child, which may have been forked off one of many threads, so it makes system calls alone. parent: the
// process with which the child shall end; 0 for none.
[[noreturn]] void become_program(const std::vector<char*>& arguments, int output, pid_t parent,
                                 const sigset_t& signals) {
  // The child stands in a process group of its own: we handle Ctrl-C on the terminal, and an encoder shall finish what
  // it has.
  ::setpgid(0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action.sa_handler = SIG_DFL;
    ::sigaction(signal, &action, nullptr);
  }
  if (parent != 0) ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (parent != 0 && ::getppid() != parent) ::_exit(cannot_start);  // the parent has already ended
  ::dup2(::open("/dev/null", O_RDONLY | O_CLOEXEC), 0);
  ::dup2(output, 1);
  ::dup2(output, 2);
  ::pthread_sigmask(SIG_SETMASK, &signals, nullptr);
  ::execvp(arguments[0], arguments.data());
  ::_exit(cannot_start);
}

}  // namespace

std::optional<ProgramEnd> run_program(const std::vector<std::string>& words, const std::function<bool()>& stop) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);  // no signal reaches our handlers in the child
  const pid_t child = ::fork();
  if (child == 0) become_program(arguments, ends[1], stop ? parent : 0, before);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    return std::nullopt;
  }
  ProgramEnd finished{0, ""};
  char buffer[4096];
  for (bool asked = false;;) {
    if (stop && !asked) asked = stopped_before_output(ends[0], child, stop);
    const ssize_t count = ::read(ends[0], buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    finished.output.append(buffer, std::size_t(count));
    if (finished.output.size() > 4096) finished.output.erase(0, finished.output.size() - 4096);
  }
  ::close(ends[0]);
  while (::waitpid(child, &finished.status, 0) < 0 && errno == EINTR) {
  }
  const bool not_found = WIFEXITED(finished.status) && WEXITSTATUS(finished.status) == cannot_start;
  return not_found ? std::nullopt : std::optional(finished);
}

std::string how_it_ended(const ProgramEnd& end) {
  return WIFSIGNALED(end.status) ? fmt::format("was ended by signal {}", WTERMSIG(end.status))
                                 : fmt::format("ended with status {}", WEXITSTATUS(end.status));
}

}  // namespace supple
