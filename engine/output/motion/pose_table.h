// Writes rigid motions as a table, one row for each frame and collider, so that another program can place the
// colliders.
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

// Returns the number of bytes of the heading and the first rows of a table, or nothing where it has fewer rows.
std::optional<std::int64_t> pose_table_bytes(const std::filesystem::path& path, int rows);

class PoseTableWriter {
 public:
  // Starts a file, or continues one after its first rows. Throws RunError when it cannot be written, or has fewer rows.
  explicit PoseTableWriter(const std::filesystem::path& path, int kept_rows = 0);

  // Writes the position [m] and the rotation as a quaternion, from the collider's frame to the world.
  void add(int frame, const std::string& name, const Eigen::Isometry3d& pose);

 private:
  std::filesystem::path path_;
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace supple
