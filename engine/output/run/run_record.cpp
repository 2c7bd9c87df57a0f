#include "output/run/run_record.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/near_files.h"
#include "base/read_file.h"
#include "output/files/json_text.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

// Checks that each frame has the bodies of the first frame, and that the same bodies have contact figures, because
// tables are made by body.
void check_bodies(const std::vector<FrameRow>& rows, const std::string& source) {
  for (const FrameRow& row : rows) {
    const bool same = std::ranges::equal(row.bodies, rows.front().bodies, [](const BodyRow& a, const BodyRow& b) {
      return a.name == b.name && a.contact.has_value() == b.contact.has_value();
    });
    if (!same) throw InputError(source, fmt::format("is damaged: frame {} has other bodies than the first", row.frame));
  }
}

}  // namespace

std::string RunRecord::ended() const {
  const Json info = parsed_json<Json>(info_json);
  return info.contains("ended") && info["ended"].is_string() ? info["ended"].get<std::string>() : "not known";
}

std::optional<double> RunRecord::frame_rate() const {
  if (rows.size() < 2 || rows.back().time_s <= rows.front().time_s) return std::nullopt;
  return double(rows.size() - 1) / (rows.back().time_s - rows.front().time_s);
}

bool is_run(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::exists(folder / "run.json", error);
}

RunRecord read_run(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    throw InputError(folder.string(), "no such folder" + meant_file(near_file(folder, is_run)));
  if (!is_run(folder)) throw InputError(folder.string(), "there is no run.json in it: this is not the folder of a run");
  RunRecord record;
  record.folder = folder;
  const Json info = json_if_valid<Json>(read_file(folder / "run.json"));
  if (!info.is_object()) throw InputError((folder / "run.json").string(), "is damaged: not a JSON object");
  record.info_json = exact_json_text(info);
  record.has_profile = std::filesystem::exists(folder / "profile.json", error);
  if (record.has_profile) {
    record.rows = read_profile(folder / "profile.json");
    check_bodies(record.rows, (folder / "profile.json").string());
  }
  return record;
}

}  // namespace supple
