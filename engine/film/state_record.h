// Records of a film's states, frame by frame, to be compared with those of another run: for --record and --verify.
// docs/replays.md has the format.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/model/model.h"
#include "sim/model/state.h"

namespace supple {

// The head of a record: what it was made of.
struct RecordHead {
  std::string program, kernels;  // identities: the same bits are promised only where both are the same
  std::string film;              // JSON of the scene and the replay
  struct Body {
    std::string name;
    int vertices = 0;
  };
  std::vector<Body> bodies;
};

// Whether a record may be written to this path: there is no file yet, an empty one, or a record of any version.
bool may_be_recorded_over(const std::filesystem::path& path);

// Throws InputError where the file is not a record that begins with the first frames of the film.
void check_kept_record(const std::filesystem::path& path, const RecordHead& head, int kept_frames);

class StateRecorder {
 public:
  // Starts a file, or continues one after its first frames. Throws RunError when it cannot be written, InputError as
  // check_kept_record does.
  StateRecorder(const std::filesystem::path& path, const RecordHead& head, int kept_frames);
  void add(const Model& model, const State& state);  // body by body, frame by frame

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

class StateVerifier {
 public:
  // tolerance: how far a vertex may be from the record, over the body's size; nothing: the same bits, and then the
  // record must be of this program. Throws InputError: not a record, damaged, or of other bodies or another program.
  StateVerifier(const std::filesystem::path& path, const RecordHead& now, std::optional<double> tolerance,
                int skipped_frames);

  // A remark for before the run: that the scene is not the recorded one, and in what it differs. Empty where it is.
  const std::string& remark() const { return remark_; }

  // Body by body, frame by frame. Returns in what it differs; nothing where it does not, and after the end of the
  // record.
  std::string compare(int frame, const Model& model, const State& state);

  // Once the film has so many frames.
  bool compared_any(int frames) const;
  std::string verdict(int frames) const;

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  RecordHead head_;
  std::optional<double> tolerance_;
  std::size_t next_body_ = 0;
  int first_frame_;  // that is compared
  int recorded_frames_ = 0;
  double furthest_ = 0;  // over the size
  std::string remark_;
};

}  // namespace supple
