#include "app/program.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>

#include "base/console.h"
#include "base/error.h"

namespace supple {
namespace {

// Throws InputError where the working folder has been removed, from which every relative path would lead nowhere.
void check_working_folder() {
  std::error_code error;
  (void)std::filesystem::current_path(error);
  if (!error) return;
  const char* name = std::getenv("PWD");
  throw InputError(name != nullptr ? name : "the working folder",
                   fmt::format("the folder that the command was called in cannot be used: {}; cd to one that is there",
                               error.message()));
}

int run(int argc, char** argv, const std::function<void(CommandLine&)>& add_verbs) {
  CommandLine line(argc, argv);
  add_verbs(line);
  if (const std::optional<int> status = line.read()) return *status;
  check_working_folder();
  const int status = line.run();
  const bool said = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  return status == 0 && !said ? 1 : status;
}

// Opens /dev/null for each standard stream that is closed: a user who closes a stream wants no output from it.
// Otherwise the next file that is opened would get the stream's number, and the stream's text would go into that file.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", O_RDWR);  // gets the lowest free number: this one
}

}  // namespace

int run_command_line(int argc, char** argv, const std::function<void(CommandLine&)>& add_verbs) {
  open_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);  // a run continues when its listener has gone
  try {
    return run(argc, argv, add_verbs);
  } catch (const InputError& error) {
    say(stderr, fmt::format("{}\n", error.what()));
    return 2;
  } catch (const std::filesystem::filesystem_error& error) {
    const std::string where = error.path1().empty() ? "" : error.path1().string() + ": ";
    say(stderr, fmt::format("supple: {}{}\n", where, error.code().message()));
    return 1;
  } catch (const std::bad_alloc&) {
    say(stderr, fmt::format("supple: out of memory\n"));
    return 1;
  } catch (const std::exception& error) {
    say(stderr, fmt::format("supple: {}\n", error.what()));
    return 1;
  }
}

}  // namespace supple
