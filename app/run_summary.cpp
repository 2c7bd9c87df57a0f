#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "app/summary.h"
#include "base/text.h"
#include "output/files/json_text.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

// Returns the text at a path such as {"program", "version"}, or "not known" where an older program did not write it.
std::string value_at(const Json& info, const std::vector<std::string>& path) {
  const Json* value = &info;
  for (const std::string& key : path) {
    if (!value->is_object() || !value->contains(key)) return "not known";
    value = &(*value)[key];
  }
  return printable(value->is_string() ? value->get<std::string>()
                                      : value->dump(-1, ' ', false, Json::error_handler_t::replace));
}

// Returns the command in a form that can be typed again.
std::string command_text(const Json& info) {
  if (!info.contains("command") || !info["command"].is_array()) return "not known";
  std::vector<std::string> words;
  for (const Json& word : info["command"]) {
    if (word.is_string()) words.push_back(shell_word(word.get<std::string>()));
  }
  return printable(fmt::format("{}", fmt::join(words, " ")));
}

struct FileCount {
  int files = 0;
  std::uintmax_t bytes = 0;
};

// Counts what lies directly in a run's folder: files by name, and folders (with a '/') with all that they contain.
std::map<std::string, FileCount> contents_of(const std::filesystem::path& folder) {
  std::map<std::string, FileCount> contents;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory(error)) {
      contents[name] = {1, entry.file_size(error)};
      continue;
    }
    FileCount& all = contents[name + "/"];
    for (const auto& inner : std::filesystem::recursive_directory_iterator(entry.path(), error)) {
      if (!inner.is_regular_file(error)) continue;
      ++all.files;
      all.bytes += inner.file_size(error);
    }
  }
  return contents;
}

// Counts the pictures from frame 0 up to the first gap.
int whole_pictures(const std::filesystem::path& folder) {
  std::error_code error;
  int frame = 0;
  while (std::filesystem::exists(picture_file(folder / "frames", frame), error)) ++frame;
  return frame;
}

std::string errors_text(const std::vector<FrameRow>& rows) {
  const auto measured = [](const FrameRow& row) {
    return std::ranges::any_of(row.bodies, [](const BodyRow& body) { return body.error_measured; });
  };
  const auto count = std::ranges::count_if(rows, measured);
  return count == 0 ? "not measured" : fmt::format("measured at {} of {} frames", count, rows.size());
}

std::string bodies_text(const Json& info) {
  std::string text;
  if (!info.contains("meshes") || !info["meshes"].is_array()) return text;
  for (const Json& mesh : info["meshes"]) {
    text += fmt::format("  body            '{}': {} vertices, {} elements ({})\n", value_at(mesh, {"body"}),
                        value_at(mesh, {"vertices"}), value_at(mesh, {"elements"}), value_at(mesh, {"source"}));
  }
  return text;
}

std::string files_text(const std::filesystem::path& folder) {
  std::string text = "\n  files\n";
  for (const auto& [name, count] : contents_of(folder)) {
    const std::string files = name.ends_with('/') ? fmt::format("{} files", count.files) : "";
    text += fmt::format("    {:<20}{:>12}  {}", printable(name), bytes_text(count.bytes), files);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

}  // namespace

std::string run_summary(const RunRecord& run) {
  const Json info = parsed_json<Json>(run.info_json);
  std::string text = fmt::format("  run             {}\n", printable(run.folder.string()));
  text += fmt::format("  command         {}\n", command_text(info));
  text += fmt::format("  program         {} {}, {} kernels, {}\n", value_at(info, {"program", "name"}),
                      value_at(info, {"program", "version"}), value_at(info, {"program", "kernels"}),
                      value_at(info, {"program", "build"}));
  text += fmt::format("  machine         {}, {} threads\n", value_at(info, {"machine", "cpu"}),
                      value_at(info, {"machine", "threads"}));
  text += fmt::format("  scene           {}\n{}", value_at(info, {"scene_file"}), bodies_text(info));
  text += fmt::format("  ended           {}\n",
                      run.ended() == "running" ? "not yet, or the run was killed" : printable(run.ended()));
  text +=
      fmt::format("  frames          {} in profile.json, {} pictures\n", run.rows.size(), whole_pictures(run.folder));
  if (info.contains("resumed_at"))
    text += fmt::format("  resumed         after frames {}\n", value_at(info, {"resumed_at"}));
  text += fmt::format("  film            {}\n", info.contains("video") ? value_at(info, {"video"}) : "none");
  if (run.has_profile) {
    text += fmt::format("  errors          {}\n", errors_text(run.rows));
    if (!run.rows.empty()) text += "\n" + profile_table(run.rows);
  }
  return text + files_text(run.folder);
}

}  // namespace supple
