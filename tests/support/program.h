// The program, run as a user does.
#pragma once

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::test {

struct Result {
  int status;  // negative: of the signal that ended it
  std::string out, err;
};

// Runs the program in `folder`; with a path in signal_when it gets the signal once that file exists.
Result run(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
           const std::filesystem::path& signal_when = {}, int signal = SIGINT);

// The same, and SIGKILL after some milliseconds.
Result run_and_kill(const std::filesystem::path& folder, const std::vector<std::string>& arguments, int milliseconds);

nlohmann::json profile_of(const std::filesystem::path& run_folder);

}  // namespace supple::test
