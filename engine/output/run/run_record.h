// Reads back a folder that a run has left: the content of run.json and profile.json. run_folder.h writes them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "output/run/profile.h"

namespace supple {

struct RunRecord {
  std::filesystem::path folder;
  std::string info_json;       // contents of run.json, a JSON object
  std::vector<FrameRow> rows;  // contents of profile.json; empty until a run has ended
  bool has_profile = false;

  std::filesystem::path motion(const std::string& body) const { return folder / "motion" / (body + ".pc2"); }
  std::filesystem::path forces(const std::string& body) const { return folder / "motion" / (body + ".forces"); }
  std::filesystem::path surface(const std::string& body) const { return folder / "motion" / (body + ".obj"); }
  // Tells how the run ended, as run.json says: "done", "interrupted", "running" or the failure.
  std::string ended() const;
  // Returns the frames a second, by the times of the rows; nothing where there are fewer than two. (One row does not
  // tell the rate, because a film that goes on from another run does not begin at time 0.)
  std::optional<double> frame_rate() const;
};

// Tells whether a folder holds a run.
bool is_run(const std::filesystem::path& folder);

// Throws InputError naming the folder or file when there is no such folder, no run.json in it, or one of the two files
// is damaged. A folder without profile.json is read; has_profile tells.
RunRecord read_run(const std::filesystem::path& folder);

}  // namespace supple
