// Writes and reads PC2 point caches: the motion of one mesh, frame by frame, as Blender and other programs read it.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "base/types.h"

namespace supple {

// Tells whether the file has the first `frames` frames of so many points, whatever follows them.
bool point_cache_has(const std::filesystem::path& path, int points, int frames);

// Returns the positions as a cache gives them back: it holds them in single precision. A film draws these, so that it
// can be drawn again from its motion with the same bytes.
Positions as_cached(const Positions& points);

class PointCacheWriter {
 public:
  // Starts a file, or continues one after its first frames. Throws RunError when it cannot be written, or does not have
  // those frames.
  PointCacheWriter(const std::filesystem::path& path, int points, int kept_frames = 0);

  // Appends a frame (points x 3, float in the file). The count in the header is updated, so that the file is valid
  // after every frame.
  void add(const Positions& points);

 private:
  void fail(const char* doing) const;
  void continue_after(int frames);

  std::filesystem::path path_;
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  int points_;
  int frames_ = 0;
};

// Reads such a file back, frame by frame.
class PointCacheReader {
 public:
  // Throws InputError naming the file when it cannot be read, is not a PC2 file of version 1, or holds fewer bytes than
  // its header says or more than one frame beyond them. (A run that was killed may leave part of a frame that its
  // header does not count.)
  explicit PointCacheReader(const std::filesystem::path& path);

  int points() const { return points_; }
  int frames() const { return frames_; }

  // Returns the positions of a frame, 0 to frames() - 1, points x 3 [m]. Throws InputError naming the file and the
  // frame when it cannot be read, or when a number in it is not finite.
  Positions frame(int index);

 private:
  [[noreturn]] void refuse(const std::string& what) const;

  std::filesystem::path path_;
  std::ifstream file_;
  int points_ = 0;
  int frames_ = 0;
};

}  // namespace supple
