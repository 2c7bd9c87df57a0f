#include "output/run/run_folder.h"

#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "base/hash.h"
#include "base/motion_hull.h"
#include "output/files/json_text.h"
#include "output/files/whole_file.h"

namespace supple {

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string program_version() { return SUPPLE_VERSION; }
std::string build_flags() { return SUPPLE_BUILD_FLAGS; }

namespace {

constexpr const char* part_suffix = ".part";  // marks a file that is still being written

bool all_digits(std::string_view text) { return text.find_first_not_of("0123456789") == std::string_view::npos; }

// Returns the frame of a picture's file, and nothing for a file that no run writes.
std::optional<long> frame_of(const std::filesystem::path& file, const char* ending) {
  const std::string stem = file.stem().string();
  if (file.extension() != ending || stem.size() < 6 || stem.size() > 9 || !all_digits(stem)) return std::nullopt;
  return std::stol(stem);
}

// Each of these functions tells whether a run writes a file of this name into a folder of one kind: motion, fields,
// checkpoint, or a state. The name comes without the suffix of an unfinished file.
bool is_motion(const std::filesystem::path& file) {
  return file.extension() == ".pc2" || file.extension() == ".forces" || file.extension() == ".obj" ||
         file == "colliders.csv";
}
bool is_field(const std::filesystem::path& file) { return file.extension() == ".vtu" || file.extension() == ".pvd"; }
bool is_checkpoint(const std::filesystem::path& file) { return file == "state" || file == "rows.jsonl"; }
bool is_state(const std::filesystem::path& file) { return file.extension() == ".npy" || file == "state.json"; }

// Removes a run's own files; anything else in the folder belongs to the user and stays.
template <class IsOwn>
void remove_own(const std::filesystem::path& folder, const IsOwn& is_own) {
  std::error_code error;
  std::vector<std::filesystem::path> own;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    std::filesystem::path name = entry.path().filename();
    if (name.extension() == part_suffix) name = name.stem();
    if (!entry.is_directory(error) && is_own(name)) own.push_back(entry.path());
  }
  for (const std::filesystem::path& file : own) std::filesystem::remove(file, error);
}

// Removes the folders BODY-NNNNNN.
void remove_states(const std::filesystem::path& states) {
  std::error_code error;
  std::vector<std::filesystem::path> own;
  for (const auto& entry : std::filesystem::directory_iterator(states, error)) {
    const std::string name = entry.path().filename().string();
    const std::size_t dash = name.rfind('-');
    if (entry.is_directory(error) && dash != std::string::npos && name.size() - dash == 7 &&
        all_digits(std::string_view(name).substr(dash + 1)))
      own.push_back(entry.path());
  }
  for (const std::filesystem::path& state : own) {
    remove_own(state, is_state);
    std::filesystem::remove(state, error);  // fails when the folder holds anything else
  }
}

// Removes the motion, the fields and the states that a run has left.
void remove_run(const std::filesystem::path& run) {
  remove_own(run / "motion", is_motion);
  remove_own(run / "fields", is_field);
  remove_states(run / "states");
  std::error_code error;
  for (const char* folder : {"fields", "states"}) {
    if (std::filesystem::is_empty(run / folder, error)) std::filesystem::remove(run / folder, error);
  }
}

// Tells whether the folder holds only what a run makes at its very beginning.
bool is_beginning_of_run(const std::filesystem::path& path) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(path, error)) {
    const std::string name = entry.path().filename().string();
    const bool own_folder = (name == "frames" || name == "motion" || name == "checkpoint") &&
                            entry.is_directory(error) && std::filesystem::is_empty(entry.path(), error);
    if (!own_folder && name != "run.json.part") return false;
  }
  return true;
}

// Removes the page of an earlier run, which shows another film than the folder will have.
void remove_page(const std::filesystem::path& page) {
  std::string head(1000, '\0');
  std::ifstream file(page, std::ios::binary);
  file.read(head.data(), std::streamsize(head.size()));
  std::error_code error;
  if (head.find(page_mark) != std::string::npos) std::filesystem::remove(page, error);
}

void make_folder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw RunError(fmt::format("{}: cannot be made: {}", path.string(), error.message()));
}

}  // namespace

RunFolder::RunFolder(const std::filesystem::path& path, int kept_frames) : path_(path) {
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    if (!std::filesystem::is_directory(path, error))
      throw InputError("--out " + path.string(), "exists and is not a folder");
    if (!std::filesystem::exists(path / "run.json", error) && !is_beginning_of_run(path)) {
      throw InputError("--out " + path.string(),
                       "holds files that no run left there (no run.json); choose another folder or empty it");
    }
  }
  make_folder(path);
  if (kept_frames == 0) {
    // run.json comes first: from now on the folder is known as a run's, and its old contents no longer count.
    write_whole_file(path / "run.json", std::string_view("{}\n"));
    remove_own(path / "checkpoint", is_checkpoint);
    remove_run(path);
    remove_page(path / "index.html");
  }
  remove_pictures(path / "frames", kept_frames);
  remove_passes(path / "passes", kept_frames);
  remove_film(path);
  for (const char* part : {"profile.json", "trace.json"}) std::filesystem::remove(path / part, error);
  for (const char* part : {"frames", "motion", "checkpoint"}) make_folder(path / part);
}

void remove_film(const std::filesystem::path& folder) {
  std::error_code error;
  for (const char* ending : {"mp4", "webm", "mov", "gif"}) {
    for (const char* film : {"video.", "video.part."})
      std::filesystem::remove(folder / (std::string(film) + ending), error);
  }
  for (const char* still : {"poster.png", "sheet.png"}) std::filesystem::remove(folder / still, error);
}

void remove_pictures(const std::filesystem::path& frames, int first) {
  remove_own(frames, [first](const std::filesystem::path& file) {
    const std::optional<long> frame = frame_of(file, ".png");
    return frame && *frame >= first;
  });
}

void remove_passes(const std::filesystem::path& passes, int first) {
  std::error_code error;
  std::vector<std::filesystem::path> folders;
  for (const Name<PicturePass>& pass : Names<PicturePass>::table) folders.push_back(passes / pass.text);
  for (const auto& entry :
       std::filesystem::directory_iterator(pass_file(passes, PicturePass::masks, "", 0).parent_path(), error))
    if (entry.is_directory(error)) folders.insert(folders.begin(), entry.path());
  for (const std::filesystem::path& folder : folders) {
    remove_own(folder, [first](const std::filesystem::path& file) {
      const std::optional<long> frame = frame_of(file, ".exr");
      return frame && *frame >= first;
    });
    if (std::filesystem::is_empty(folder, error)) std::filesystem::remove(folder, error);
  }
  if (std::filesystem::is_empty(passes, error)) std::filesystem::remove(passes, error);
}

std::filesystem::path pass_file(const std::filesystem::path& passes, PicturePass pass, const std::string& mesh,
                                int index) {
  return passes / name_of(pass) / mesh / fmt::format("{:06}.exr", index);
}

std::filesystem::path picture_file(const std::filesystem::path& frames, int index) {
  return frames / fmt::format("{:06}.png", index);
}

std::filesystem::path RunFolder::state(const std::string& body, int frame) const {
  return path_ / "states" / fmt::format("{}-{:06}", body, frame);
}

std::filesystem::path RunFolder::fields(const std::string& body, int frame) const {
  return fields() / fmt::format("{}-{:06}.vtu", body, frame);
}

std::vector<Vec3> framed_in(const std::string& info_json) {
  const auto info = json_if_valid<nlohmann::ordered_json>(info_json);
  if (!info.is_object() || !info.contains("framed")) return {};
  try {
    std::vector<Vec3> points;
    for (const auto& p : info["framed"].get<std::vector<std::vector<double>>>())
      points.emplace_back(p.at(0), p.at(1), p.at(2));
    return points.size() == 2 ? corners_of(box_around(points)) : points;  // older programs wrote a box
  } catch (const std::exception&) {
    throw InputError("run.json", "is damaged: 'framed' is not a list of points");
  }
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
  if (info.scene_text) json["scene_text"] = *info.scene_text;
  if (info.preview) json["preview"] = true;
  for (const Vec3& p : info.framed) json["framed"].push_back({p.x(), p.y(), p.z()});
  json["settings"] = info.settings;
  if (info.sweep_point) json["sweep_point"] = *info.sweep_point;
  json["scene"] = json_if_valid<nlohmann::ordered_json>(info.scene_json);
  if (!info.replay_json.empty()) json["replay"] = json_if_valid<nlohmann::ordered_json>(info.replay_json);
  if (!info.resumed.empty()) json["resumed_at"] = info.resumed;
  if (!info.video.empty()) json["video"] = info.video;
  // File names need not be UTF-8, but JSON must be.
  return json_text(json, 1) + "\n";
}

void RunFolder::write_info(const RunInfo& info) const { write_durable_file(path_ / "run.json", info_json(info)); }

void RunFolder::write_profile(const FrameRows& rows, const RowTally& tally, const std::string& verdict) const {
  write_durable_file(path_ / "profile.json",
                     [&](const TakesText& take) { supple::write_profile(rows, tally, verdict, take); });
}

}  // namespace supple
