// Runs the program as a user does.
#pragma once

#include <csignal>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace supple::test {

struct Result {
  int status;  // exit status, or minus the signal that ended it
  std::string out, err;
};

// Runs the program in `folder`. If signal_when names a path, the program gets the signal once that file exists.
Result run(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
           const std::filesystem::path& signal_when = {}, int signal = SIGINT);

// Does the same, and sends SIGKILL after some milliseconds.
Result run_and_kill(const std::filesystem::path& folder, const std::vector<std::string>& arguments, int milliseconds);

nlohmann::json profile_of(const std::filesystem::path& run_folder);

}  // namespace supple::test
