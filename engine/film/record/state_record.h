// Writes records of a film's states, frame by frame, and compares another run's states with them, for --record and
// --verify. docs/replays.md describes the format.
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

// Describes what a record was made from. It is stored at the head of the record.
struct RecordHead {
  std::string program, kernels;  // identities: the same bits are promised only where both are the same
  std::string film;              // JSON of the scene and the replay
  struct Body {
    std::string name;
    int vertices = 0;
  };
  std::vector<Body> bodies;
};

// Tells whether a record may be written to this path: no file exists there yet, or it is empty, or it is a record of
// any version.
bool may_be_recorded_over(const std::filesystem::path& path);

// Checks a record that is to be continued. Throws InputError when the file is not a record that begins with the first
// frames of the film.
void check_kept_record(const std::filesystem::path& path, const RecordHead& head, int kept_frames);

class StateRecorder {
 public:
  // Starts a file, or continues one after its first frames. Throws RunError when it cannot be written, and InputError
  // as check_kept_record does.
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
  // tolerance: how far a vertex may be from the record, relative to the body's size; without a value, the bits must be
  // the same, and the record must come from this program. Throws InputError when the file is not a record, is damaged,
  // or is of other bodies or of another program.
  StateVerifier(const std::filesystem::path& path, const RecordHead& now, std::optional<double> tolerance,
                int skipped_frames);

  // Returns a note to be printed before the run that says how the scene differs from the recorded one; empty where it
  // is the same.
  const std::string& remark() const { return remark_; }

  // Takes the states body by body, frame by frame. Returns a description of the difference; empty where there is none,
  // and after the end of the record.
  std::string compare(int frame, const Model& model, const State& state);

  // These functions are valid once the film has that many frames.
  bool compared_any(int frames) const;
  std::string verdict(int frames) const;

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  RecordHead head_;
  std::optional<double> tolerance_;
  std::size_t next_body_ = 0;
  int first_frame_;  // the first frame that is compared
  int recorded_frames_ = 0;
  double furthest_ = 0;  // largest distance of a vertex from the record, over the body's size
  std::string remark_;
};

}  // namespace supple
