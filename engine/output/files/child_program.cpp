#include "output/files/child_program.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <mutex>
#include <set>
#include <utility>

namespace supple {

namespace {

// Waits until the child has written something or has ended. Where stop() returns true before that, sends the child
// SIGINT and returns true; otherwise returns false.
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

// Names the signal that a child gets when the thread that started it ends; 0: none.
struct Bond {
  int signal = 0;
  pid_t parent = 0;
};

// Turns the child into the program. The child may have been forked from one of many threads, so this function makes
// only system calls.
[[noreturn]] void become_program(const std::vector<char*>& arguments, int input, int output, Bond bond,
                                 const sigset_t& signals) {
  // The child runs in a process group of its own: this process handles Ctrl-C on the terminal, and an encoder must be
  // able to finish the frames that it has.
  ::setpgid(0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action.sa_handler = SIG_DFL;
    ::sigaction(signal, &action, nullptr);
  }
  if (bond.signal != 0) ::prctl(PR_SET_PDEATHSIG, bond.signal);
  if (bond.signal != 0 && ::getppid() != bond.parent) ::_exit(cannot_start);  // the parent has already ended
  ::dup2(input >= 0 ? input : ::open("/dev/null", O_RDONLY | O_CLOEXEC), 0);
  ::dup2(output, 1);
  ::dup2(output, 2);
  ::pthread_sigmask(SIG_SETMASK, &signals, nullptr);
  ::execvp(arguments[0], arguments.data());
  ::_exit(cannot_start);
}

// Forks and starts the program. input: its standard input; -1: an empty one. Returns -1 when it cannot fork.
pid_t start_program(const std::vector<std::string>& words, int input, int output, int bond) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);  // no signal reaches our handlers in the child
  const pid_t child = ::fork();
  if (child == 0) become_program(arguments, input, output, {bond, parent}, before);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return child;
}

// Appends the bytes that can be read, and keeps the last 4 kB of the text. Returns false at the end.
bool read_some(int file, std::string& text) {
  constexpr std::size_t kept = 4096;
  char buffer[4096];
  ssize_t count = 0;
  while ((count = ::read(file, buffer, sizeof buffer)) < 0 && errno == EINTR) {
  }
  if (count <= 0) return false;
  text.append(buffer, std::size_t(count));
  if (text.size() > kept) text.erase(0, text.size() - kept);
  return true;
}

// Returns nothing when the program could not be started.
std::optional<ProgramEnd> wait_for_end(pid_t child, std::string output) {
  ProgramEnd end{0, std::move(output)};
  rusage used{};
  while (::wait4(child, &end.status, 0, &used) < 0 && errno == EINTR) {
  }
  for (const timeval& time : {used.ru_utime, used.ru_stime})
    end.cpu_ms += double(time.tv_sec) * 1e3 + double(time.tv_usec) * 1e-3;
  const bool not_found = WIFEXITED(end.status) && WEXITSTATUS(end.status) == cannot_start;
  return not_found ? std::nullopt : std::optional(std::move(end));
}

// While one of these objects lives, SIGPIPE is blocked in the calling thread; a signal that arrived meanwhile is
// dropped at the end.
class NoSigpipe {
 public:
  NoSigpipe() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoSigpipe() {
    const timespec at_once{};
    while (!was_pending_ && ::sigtimedwait(&pipe_, nullptr, &at_once) < 0 && errno == EINTR) {
    }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoSigpipe(const NoSigpipe&) = delete;
  NoSigpipe& operator=(const NoSigpipe&) = delete;

 private:
  sigset_t pipe_, before_;
  bool was_pending_ = false;
};

}  // namespace

std::string file_word(const std::filesystem::path& file) { return std::filesystem::absolute(file).string(); }

std::optional<ProgramEnd> run_program(const std::vector<std::string>& words, const std::function<bool()>& stop) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  const pid_t child = start_program(words, -1, ends[1], stop ? SIGTERM : 0);
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    return std::nullopt;
  }
  std::string output;
  bool asked = false;
  do {
    if (stop && !asked) asked = stopped_before_output(ends[0], child, stop);
  } while (read_some(ends[0], output));
  ::close(ends[0]);
  return wait_for_end(child, std::move(output));
}

// Lists the programs that this process feeds, so that a process that is forked from it can close their pipes.
struct FedPrograms {
  std::mutex mutex;
  std::set<FedProgram*> programs;

  static FedPrograms& all() {
    static FedPrograms& list = *new FedPrograms;  // never destroyed: a process may be forked at any time
    static const int registered =
        ::pthread_atfork([] { all().mutex.lock(); }, [] { all().mutex.unlock(); }, [] { all().forget(); });
    (void)registered;
    return list;
  }
  void forget() {
    for (FedProgram* program : programs) program->forget();
    programs.clear();
    mutex.unlock();
  }
  void add(FedProgram* program) {
    const std::lock_guard lock(mutex);
    programs.insert(program);
  }
  void remove(FedProgram* program) {
    const std::lock_guard lock(mutex);
    programs.erase(program);
  }
};

void FedProgram::forget() {
  close_input();
  if (output_ >= 0) ::close(output_);
  output_ = child_ = -1;
}

FedProgram::FedProgram(const std::vector<std::string>& words) {
  int input[2], output[2];
  if (::pipe2(input, O_CLOEXEC) != 0) return;
  if (::pipe2(output, O_CLOEXEC) != 0) {
    for (const int end : input) ::close(end);
    return;
  }
  child_ = start_program(words, input[0], output[1], SIGKILL);
  ::close(input[0]);
  ::close(output[1]);
  input_ = input[1];
  output_ = output[0];
  constexpr int pipe_bytes = 1 << 20;  // fewer changes between the two programs; the system may grant less
  (void)::fcntl(input_, F_SETPIPE_SZ, pipe_bytes);
  (void)::fcntl(input_, F_SETFL, O_NONBLOCK);
  FedPrograms::all().add(this);
  if (child_ < 0) close_input();
}

FedProgram::~FedProgram() {
  FedPrograms::all().remove(this);
  if (child_ >= 0) ::kill(child_, SIGKILL);  // before it can take the end of its input for the end of its work
  close_input();
  if (output_ >= 0) ::close(output_);
  if (child_ >= 0) (void)wait_for_end(child_, "");
}

void FedProgram::close_input() {
  if (input_ >= 0) ::close(input_);
  input_ = -1;
}

// Waits until the program takes bytes or has ended. Meanwhile it reads what the program writes, because the program may
// be waiting for that in turn. Returns false when waiting fails.
bool FedProgram::wait_for_room() {
  pollfd waited[] = {{input_, POLLOUT, 0}, {output_, POLLIN, 0}};
  if (::poll(waited, 2, -1) < 0) return errno == EINTR;
  if (waited[1].revents != 0 && !read_some(output_, told_)) {
    ::close(output_);
    output_ = -1;
  }
  return true;
}

bool FedProgram::write(std::span<const std::uint8_t> bytes) {
  const NoSigpipe meanwhile;
  while (!bytes.empty() && input_ >= 0) {
    const ssize_t count = ::write(input_, bytes.data(), bytes.size());
    if (count >= 0) {
      bytes = bytes.subspan(std::size_t(count));
    } else if (errno == EINTR) {
      continue;
    } else if (errno != EAGAIN || !wait_for_room()) {
      close_input();
    }
  }
  return bytes.empty();
}

std::optional<ProgramEnd> FedProgram::finish() {
  close_input();
  while (output_ >= 0 && read_some(output_, told_)) {
  }
  if (output_ >= 0) ::close(output_);
  output_ = -1;
  if (child_ < 0) return std::nullopt;
  return wait_for_end(std::exchange(child_, -1), std::move(told_));
}

std::string how_it_ended(const ProgramEnd& end) {
  return WIFSIGNALED(end.status) ? fmt::format("was ended by signal {}", WTERMSIG(end.status))
                                 : fmt::format("ended with status {}", WEXITSTATUS(end.status));
}

}  // namespace supple
