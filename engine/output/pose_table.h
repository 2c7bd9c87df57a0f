// Rigid motions as a table: a row a frame and collider, for whoever wants to place them in another program.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/types.h"

namespace supple {

// Of the heading and the first rows of a table; nothing where it has fewer.
std::optional<std::int64_t> pose_table_bytes(const std::filesystem::path& path, int rows);

class PoseTableWriter {
 public:
  // Starts a file, or goes on behind the first rows of one. Throws RunError when it cannot be written, or has fewer.
  explicit PoseTableWriter(const std::filesystem::path& path, int kept_rows = 0);

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
