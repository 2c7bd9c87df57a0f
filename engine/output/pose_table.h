// Rigid motions as a table: a row a frame and collider, for whoever wants to place them in another program.
#pragma once

#include <Eigen/Geometry>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "base/types.h"

namespace supple {

class PoseTableWriter {
 public:
  // Starts a file, or goes on behind the first frames of one. Throws RunError when it cannot be written.
  explicit PoseTableWriter(const std::filesystem::path& path, int kept_frames = 0);

  // Position [m] and rotation as a quaternion, from the collider's frame to the world.
  void add(int frame, const std::string& name, const Eigen::Isometry3d& pose);

 private:
  std::filesystem::path path_;
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace supple
