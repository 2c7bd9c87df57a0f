// PC2 point caches: the motion of one mesh, frame by frame, as Blender and others read it.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "base/types.h"

namespace supple {

// Whether the file has the first frames of so many points, whatever is behind them.
bool point_cache_has(const std::filesystem::path& path, int points, int frames);

class PointCacheWriter {
 public:
  // Starts a file, or goes on behind the first frames of one. Throws RunError when it cannot be written, or does not
  // have those frames.
  PointCacheWriter(const std::filesystem::path& path, int points, int kept_frames = 0);

  // Appends a frame (points x 3, float in the file). The header's count is brought up to date, so that the file is
  // valid after every frame.
  void add(const Positions& points);

 private:
  void fail(const char* doing) const;
  void go_on_behind(int frames);

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
  // Throws InputError naming the file: it cannot be read, is not a PC2 file of version 1, or holds fewer bytes than its
  // header tells or more than one frame beyond (a run that was killed may leave part of a frame that nobody counted).
  explicit PointCacheReader(const std::filesystem::path& path);

  int points() const { return points_; }
  int frames() const { return frames_; }

  // Positions of a frame, 0 to frames() - 1, points x 3 [m]. Throws InputError naming the file and the frame: it cannot
  // be read, or a number in it is not finite.
  Positions frame(int index);

 private:
  [[noreturn]] void refuse(const std::string& what) const;

  std::filesystem::path path_;
  std::ifstream file_;
  int points_ = 0;
  int frames_ = 0;
};

}  // namespace supple
