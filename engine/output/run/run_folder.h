// Manages the folder that a run leaves behind: run.json, frames/, video.mp4 (or .webm, .mov, .gif), motion/,
// profile.json and checkpoint/, and passes/, states/ and fields/ if they were requested.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/picture_pass.h"
#include "base/types.h"
#include "output/run/profile.h"

namespace supple {

struct RunInfo {
  std::vector<std::string> command;       // the command line
  std::string scene_file;                 // an absolute path
  std::optional<std::string> scene_text;  // the scene, where no file holds it: from standard input, or made for a model
  std::vector<Vec3> framed;               // outermost points that a first pass found for the camera; empty: none [m]
  bool preview = false;                   // whether pictures have a quarter of the size, and meshes are coarse
  std::vector<std::string> settings;      // path=value, in place of the scene's values
  std::optional<std::size_t> sweep_point;
  std::string scene_json;   // the scene at the start of the film, after --set
  std::string replay_json;  // the file of a replay, else empty
  struct Mesh {
    std::string body, source, hash;
    int vertices = 0, elements = 0;
  };
  std::vector<Mesh> meshes;
  std::string kernel_variant;
  int threads = 1;
  std::string gl_backend, gl_renderer, gl_version;  // empty without images
  int frames = 0;                                   // number of finished frames
  std::vector<int> resumed;                         // frames at which it was resumed
  std::string video;                                // name of its file, or why there is none
  std::string ended;                                // "running", "done", "interrupted" or the failure's message
};

// Returns RunInfo::framed from the text of a run.json; empty where it has none. Throws InputError where it is damaged.
std::vector<Vec3> framed_in(const std::string& info_json);

// Returns the information as the text of run.json.
std::string info_json(const RunInfo& info);

// Returns the file of a frame's picture in a folder of pictures.
std::filesystem::path picture_file(const std::filesystem::path& frames, int index);
// Returns the file of a frame's pass in a folder of passes. mesh: the name of the mesh whose mask it is; empty for
// other passes.
std::filesystem::path pass_file(const std::filesystem::path& passes, PicturePass pass, const std::string& mesh,
                                int index);
// Removes the passes of frames from `first` on, also incomplete ones. Other files stay.
void remove_passes(const std::filesystem::path& passes, int first);
// Removes the film in a folder, of any format, with its poster and sheet.
void remove_film(const std::filesystem::path& folder);
// Removes the pictures of frames from `first` on, also incomplete ones. Other files stay.
void remove_pictures(const std::filesystem::path& frames, int first);

// Stands in the head of all pages that the program makes, so that a page is known from one that somebody else wrote.
inline constexpr std::string_view page_mark = "<meta name=\"generator\" content=\"supple\">";

class RunFolder {
 public:
  // Makes the folder, or takes over one that an earlier run left. That run's results are removed, except for what
  // belongs to its first `kept_frames` frames, after which it is to continue. Files that no run writes stay where they
  // are. Throws InputError when the folder holds something else, RunError when it cannot be made.
  explicit RunFolder(const std::filesystem::path& path, int kept_frames = 0);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path frames() const { return path_ / "frames"; }
  std::filesystem::path passes() const { return path_ / "passes"; }
  std::filesystem::path frame(int index) const { return picture_file(frames(), index); }
  std::filesystem::path motion(const std::string& body) const { return path_ / "motion" / (body + ".pc2"); }
  std::filesystem::path forces(const std::string& body) const { return path_ / "motion" / (body + ".forces"); }
  std::filesystem::path surface(const std::string& body) const { return path_ / "motion" / (body + ".obj"); }
  std::filesystem::path colliders() const { return path_ / "motion" / "colliders.csv"; }
  std::filesystem::path state(const std::string& body, int frame) const;  // a folder
  std::filesystem::path fields() const { return path_ / "fields"; }
  std::filesystem::path fields(const std::string& body, int frame) const;
  std::filesystem::path field_collection(const std::string& body) const { return fields() / (body + ".pvd"); }
  std::filesystem::path trace() const { return path_ / "trace.json"; }  // written if it is asked for
  std::filesystem::path checkpoint() const { return checkpoint_of(path_); }
  std::filesystem::path rows() const { return path_ / "checkpoint" / "rows.jsonl"; }  // rows of profile.json so far
  static std::filesystem::path checkpoint_of(const std::filesystem::path& run) { return run / "checkpoint" / "state"; }

  void write_info(const RunInfo& info) const;
  void write_profile(const FrameRows& rows, const RowTally& tally, const std::string& verdict) const;

 private:
  std::filesystem::path path_;
};

// These functions give the program's version and how it was built, as run.json holds them.
std::string program_version();
std::string build_flags();
std::string cpu_name();  // name of this machine's processor; "unknown" where the system does not tell

}  // namespace supple
