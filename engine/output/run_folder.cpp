#include "output/run_folder.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "output/whole_file.h"

namespace supple {

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::uint64_t program_identity() {
  static const std::uint64_t identity = [] {
    std::ifstream file("/proc/self/exe", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    return hash_text(bytes);
  }();
  return identity;
}

std::string program_version() { return SUPPLE_VERSION; }
std::string build_flags() { return SUPPLE_BUILD_FLAGS; }

namespace {

void remove_frames_from(const std::filesystem::path& frames, int first) {
  std::error_code error;
  std::vector<std::filesystem::path> later;
  for (const auto& entry : std::filesystem::directory_iterator(frames, error)) {
    if (entry.path().filename().string() >= fmt::format("{:06}.png", first)) later.push_back(entry.path());
  }
  for (const std::filesystem::path& file : later) std::filesystem::remove(file, error);
}

}  // namespace

RunFolder::RunFolder(const std::filesystem::path& path, int kept_frames) : path_(path) {
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    if (!std::filesystem::is_directory(path, error))
      throw InputError("--out " + path.string(), "exists and is not a folder");
    const bool empty = std::filesystem::is_empty(path, error);
    if (!empty && !std::filesystem::exists(path / "run.json", error)) {
      throw InputError("--out " + path.string(),
                       "holds files that no run left there (no run.json); choose another folder or empty it");
    }
  }
  if (kept_frames == 0) {
    for (const char* part : {"frames", "motion", "states", "fields", "checkpoint"})
      std::filesystem::remove_all(path / part, error);
  }
  remove_frames_from(path / "frames", kept_frames);
  for (const char* part : {"video.mp4", "profile.json", "trace.json"}) std::filesystem::remove(path / part, error);
  for (const char* part : {"frames", "motion", "checkpoint"}) {
    std::filesystem::create_directories(path / part, error);
    if (error) throw RunError(fmt::format("{}: cannot be made: {}", (path / part).string(), error.message()));
  }
  // From now on the folder is known as a run's.
  if (kept_frames == 0) write_whole_file(path / "run.json", std::string_view("{}\n"));
}

std::filesystem::path RunFolder::frame(int index) const { return frames() / fmt::format("{:06}.png", index); }

std::filesystem::path RunFolder::state(const std::string& body, int frame) const {
  return path_ / "states" / fmt::format("{}-{:06}", body, frame);
}

std::filesystem::path RunFolder::fields(const std::string& body, int frame) const {
  return fields() / fmt::format("{}-{:06}.vtu", body, frame);
}

std::string info_json(const RunInfo& info) {
  nlohmann::ordered_json json;
  json["program"] = {
      {"name", "supple"}, {"version", program_version()}, {"build", build_flags()}, {"kernels", info.kernel_variant}};
  json["command"] = info.command;
  json["ended"] = info.ended;
  json["frames"] = info.frames;
  json["machine"] = {{"cpu", cpu_name()}, {"threads", info.threads}};
  if (!info.gl_backend.empty())
    json["gl"] = {{"backend", info.gl_backend}, {"renderer", info.gl_renderer}, {"version", info.gl_version}};
  json["meshes"] = nlohmann::ordered_json::array();
  for (const RunInfo::Mesh& mesh : info.meshes) {
    json["meshes"].push_back({{"body", mesh.body},
                              {"source", mesh.source},
                              {"xxh64", mesh.hash},
                              {"vertices", mesh.vertices},
                              {"elements", mesh.elements}});
  }
  json["scene_file"] = info.scene_file;
  json["scene"] = nlohmann::ordered_json::parse(info.scene_json, nullptr, false);
  if (!info.replay_json.empty()) json["replay"] = nlohmann::ordered_json::parse(info.replay_json, nullptr, false);
  if (!info.resumed.empty()) json["resumed_at"] = info.resumed;
  if (!info.video.empty()) json["video"] = info.video;
  // File names need not be UTF-8; JSON must be.
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void RunFolder::write_info(const RunInfo& info) const { write_whole_file(path_ / "run.json", info_json(info)); }

void RunFolder::write_profile(const std::string& json) const { write_whole_file(path_ / "profile.json", json); }

}  // namespace supple
