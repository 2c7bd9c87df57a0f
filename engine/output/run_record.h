// A folder that a run left, read back: what run.json and profile.json say. Not here: writing them (run_folder.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/profile.h"

namespace supple {

struct RunRecord {
  std::filesystem::path folder;
  std::string info_json;       // run.json: a JSON object
  std::vector<FrameRow> rows;  // profile.json; empty while a run has not come to its end
  bool has_profile = false;

  std::filesystem::path motion(const std::string& body) const { return folder / "motion" / (body + ".pc2"); }
  // How the run ended, as run.json has it: "done", "interrupted", "running" or the failure.
  std::string ended() const;
};

// Throws InputError naming the folder or file: there is no such folder, no run.json in it, or one of the two files is
// damaged. A folder without profile.json is read; has_profile tells.
RunRecord read_run(const std::filesystem::path& folder);

}  // namespace supple
