// Keeps the forces of all contacts on a body's vertices, frame by frame, beside the file of its motion: a drawing of a
// saved run needs them, and they do not follow from the positions. Only vertices with a force take room. The form of
// the file is our own: a header, and for each frame the number of its vertices and, in ascending order, their numbers
// with the force as three floats.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "base/types.h"

namespace supple {

// Tells whether the file has the first `frames` frames of a body of so many vertices, whatever follows them.
bool force_file_has(const std::filesystem::path& path, int vertices, int frames);

// Returns the forces as the file gives them back: it holds them in single precision.
Positions as_kept_forces(const Positions& forces);

class ForceFileWriter {
 public:
  // Starts a file, or continues one after its first frames. Throws RunError when it cannot be written, or does not have
  // those frames.
  ForceFileWriter(const std::filesystem::path& path, int vertices, int kept_frames = 0);

  // Appends a frame. forces: vertices x 3 [N].
  void add(const Positions& forces);

 private:
  void fail(const char* doing) const;

  std::filesystem::path path_;
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  int vertices_;
};

// Reads such a file back.
class ForceFileReader {
 public:
  // Throws InputError naming the file when it cannot be read or is not such a file. A frame of which only a part was
  // written, as by a run that was killed, does not count.
  explicit ForceFileReader(const std::filesystem::path& path);

  int vertices() const { return vertices_; }
  int frames() const { return static_cast<int>(begins_.size()); }

  // Returns the forces of a frame, 0 to frames() - 1, vertices x 3 [N]. Throws InputError naming the file and the frame
  // when it is damaged: a vertex that the body does not have, or a number that is not finite.
  Positions frame(int index);

 private:
  [[noreturn]] void refuse(const std::string& what) const;

  std::filesystem::path path_;
  std::ifstream file_;
  int vertices_ = 0;
  std::vector<std::int64_t> begins_;  // of each whole frame, in bytes from the start of the file
};

}  // namespace supple
