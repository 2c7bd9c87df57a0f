// The folder that a run leaves behind: run.json, frames/, video.mp4, motion/, profile.json, checkpoint/, and states/
// and fields/ if asked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace supple {

struct RunInfo {
  std::vector<std::string> command;  // as it was called
  std::string scene_file;
  std::string scene_json;   // the scene as the film starts, after --set
  std::string replay_json;  // of a replay, its file; else empty
  struct Mesh {
    std::string body, source, hash;
    int vertices = 0, elements = 0;
  };
  std::vector<Mesh> meshes;
  std::string kernel_variant;
  int threads = 1;
  std::string gl_backend, gl_renderer, gl_version;  // empty without images
  int frames = 0;                                   // finished
  std::vector<int> resumed;                         // at these frames
  std::string video;                                // its file, or why there is none
  std::string ended;                                // "done", "interrupted" or the failure
};

// As run.json has it.
std::string info_json(const RunInfo& info);

class RunFolder {
 public:
  // Makes the folder, or takes over one that an earlier run left: its results are removed, but for what belongs to its
  // first frames when that run is to go on. Files that no run writes stay where they are. Throws InputError when the
  // folder holds something else, RunError when it cannot be made.
  explicit RunFolder(const std::filesystem::path& path, int kept_frames = 0);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path frames() const { return path_ / "frames"; }
  std::filesystem::path frame(int index) const;
  std::filesystem::path motion(const std::string& body) const { return path_ / "motion" / (body + ".pc2"); }
  std::filesystem::path surface(const std::string& body) const { return path_ / "motion" / (body + ".obj"); }
  std::filesystem::path colliders() const { return path_ / "motion" / "colliders.csv"; }
  std::filesystem::path state(const std::string& body, int frame) const;  // a folder
  std::filesystem::path fields() const { return path_ / "fields"; }
  std::filesystem::path fields(const std::string& body, int frame) const;
  std::filesystem::path field_collection(const std::string& body) const { return fields() / (body + ".pvd"); }
  std::filesystem::path video() const { return path_ / "video.mp4"; }
  std::filesystem::path trace() const { return path_ / "trace.json"; }  // if asked
  std::filesystem::path checkpoint() const { return checkpoint_of(path_); }
  std::filesystem::path rows() const { return path_ / "checkpoint" / "rows.jsonl"; }  // of profile.json, so far
  static std::filesystem::path checkpoint_of(const std::filesystem::path& run) { return run / "checkpoint" / "state"; }

  void write_info(const RunInfo& info) const;
  void write_profile(const std::string& json) const;

 private:
  std::filesystem::path path_;
};

// Version of the program and how it was built, as run.json has them.
std::string program_version();
std::string build_flags();
std::uint64_t program_identity();  // XXH64 of the program's file: another build has another one
std::string cpu_name();            // of this machine; "unknown" where the system does not tell

}  // namespace supple
