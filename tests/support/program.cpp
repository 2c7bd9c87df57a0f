#include "support/program.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "support/bodies.h"
#include "support/places.h"

namespace supple::test {

namespace {

pid_t start(const std::filesystem::path& folder, const std::vector<std::string>& arguments) {
  const pid_t child = fork();
  if (child == 0) {
    std::filesystem::current_path(folder);
    (void)!freopen("stdout.txt", "w", stdout);
    (void)!freopen("stderr.txt", "w", stderr);
    std::vector<char*> words = {const_cast<char*>(program_name)};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    execv(words[0], words.data());
    _exit(127);
  }
  return child;
}

Result result_of(pid_t child, const std::filesystem::path& folder) {
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read_file(folder / "stdout.txt"),
          read_file(folder / "stderr.txt")};
}

}  // namespace

Result run(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
           const std::filesystem::path& signal_when, int signal) {
  const pid_t child = start(folder, arguments);
  if (!signal_when.empty()) {
    siginfo_t ended{};
    while (!std::filesystem::exists(signal_when) && ended.si_pid == 0) {
      usleep(2000);
      waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
    }
    kill(child, signal);
  }
  return result_of(child, folder);
}

Result run_and_kill(const std::filesystem::path& folder, const std::vector<std::string>& arguments, int milliseconds) {
  const pid_t child = start(folder, arguments);
  usleep(static_cast<useconds_t>(milliseconds) * 1000);
  kill(child, SIGKILL);
  return result_of(child, folder);
}

nlohmann::json profile_of(const std::filesystem::path& run_folder) {
  return nlohmann::json::parse(read_file(run_folder / "profile.json"));
}

}  // namespace supple::test
