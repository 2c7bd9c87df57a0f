// The program, run as a user does.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::test {

struct Result {
  int status;  // negative: of the signal that ended it
  std::string out, err;
};

// Runs the program in `folder`; with a path in interrupt_when it gets SIGINT once that file exists.
Result run(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
           const std::filesystem::path& interrupt_when = {});

nlohmann::json profile_of(const std::filesystem::path& run_folder);

}  // namespace supple::test
