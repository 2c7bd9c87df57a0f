// The program supple makes films of soft bodies from scene files. Its exit status is 0 when it is done, 1 when the run
// failed, 2 when the input is wrong, and 130 when it was interrupted.
#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <new>

#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"

namespace {

int run(int argc, char** argv) {
  supple::CommandLine line(argc, argv);
  supple::add_render(line);
  supple::add_replay(line);
  supple::add_draw(line);
  supple::add_page(line);
  supple::add_gallery(line);
  supple::add_sweep(line);
  supple::add_profile(line);
  supple::add_bench(line);
  supple::add_check(line);
  supple::add_mesh(line);
  supple::add_info(line);
  supple::add_compare(line);
  supple::add_list(line);
  supple::add_doctor(line);
  supple::add_complete(line);
  if (const std::optional<int> status = line.read()) return *status;
  const int status = line.run();
  const bool said = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  return status == 0 && !said ? 1 : status;
}

// A file that is opened while a standard stream is closed would get the stream's number, and the stream's text would go
// into the file. A user who closes a stream wants no output from it, so such a stream leads to /dev/null.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", O_RDWR);  // the lowest that is free: this one
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);  // a run continues when its listener has gone
  try {
    return run(argc, argv);
  } catch (const supple::InputError& error) {
    supple::say(stderr, fmt::format("{}\n", error.what()));
    return 2;
  } catch (const std::bad_alloc&) {
    supple::say(stderr, fmt::format("supple: out of memory\n"));
    return 1;
  } catch (const std::exception& error) {
    supple::say(stderr, fmt::format("supple: {}\n", error.what()));
    return 1;
  }
}
