#include "output/pose_table.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "base/console.h"
#include "base/error.h"

namespace supple {

PoseTableWriter::PoseTableWriter(const std::filesystem::path& path)
    : path_(path), file_(std::fopen(path.c_str(), "w")) {
  if (!file_) throw RunError(fmt::format("{}: cannot be created: {}", path_.string(), std::strerror(errno)));
  say(file_.get(), "frame,collider,x,y,z,qw,qx,qy,qz\n");
}

void PoseTableWriter::add(int frame, const std::string& name, const Eigen::Isometry3d& pose) {
  const Vec3 p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  say(file_.get(),
      fmt::format("{},{},{},{},{},{},{},{},{}\n", frame, name, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()));
  if (std::fflush(file_.get()) != 0)
    throw RunError(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
}

}  // namespace supple
