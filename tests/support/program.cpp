#include "support/program.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/bodies.h"

namespace supple::test {

Result run(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
           const std::filesystem::path& interrupt_when) {
  const pid_t child = fork();
  if (child == 0) {
    std::filesystem::current_path(folder);
    (void)!freopen("stdout.txt", "w", stdout);
    (void)!freopen("stderr.txt", "w", stderr);
    std::vector<char*> words = {const_cast<char*>(SUPPLE_PROGRAM)};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    execv(words[0], words.data());
    _exit(127);
  }
  int status = 0;
  if (!interrupt_when.empty()) {
    while (!std::filesystem::exists(interrupt_when) && waitpid(child, &status, WNOHANG) == 0) usleep(2000);
    kill(child, SIGINT);
  }
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read_file(folder / "stdout.txt"),
          read_file(folder / "stderr.txt")};
}

nlohmann::json profile_of(const std::filesystem::path& run_folder) {
  return nlohmann::json::parse(read_file(run_folder / "profile.json"));
}

}  // namespace supple::test
