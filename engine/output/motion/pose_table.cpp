#include "output/motion/pose_table.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/console.h"
#include "base/error.h"
#include "base/trace.h"

namespace supple {

std::optional<std::int64_t> pose_table_bytes(const std::filesystem::path& path, int rows) {
  std::ifstream file(path);
  std::int64_t bytes = 0;
  std::string line;
  for (int i = 0; i <= rows; ++i) {
    if (!std::getline(file, line) || file.eof()) return std::nullopt;  // a whole row ends with a line feed
    bytes += std::int64_t(line.size()) + 1;
  }
  return bytes;
}

PoseTableWriter::PoseTableWriter(const std::filesystem::path& path, int kept_rows)
    : path_(path), file_(std::fopen(path.c_str(), kept_rows > 0 ? "r+" : "w")) {
  const auto check = [this](bool done) {
    if (!done) throw RunError(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
  };
  check(file_ != nullptr);
  if (kept_rows > 0) {
    const std::optional<std::int64_t> bytes = pose_table_bytes(path, kept_rows);
    if (!bytes)
      throw RunError(fmt::format("{}: does not have the {} rows after which to continue", path.string(), kept_rows));
    check(ftruncate(fileno(file_.get()), off_t(*bytes)) == 0 && std::fseek(file_.get(), 0, SEEK_END) == 0);
  } else {
    say(file_.get(), "frame,collider,x,y,z,qw,qx,qy,qz\n");
  }
}

void PoseTableWriter::add(int frame, const std::string& name, const Eigen::Isometry3d& pose) {
  const Zone zone("motion files", name);
  const Vec3 p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  say(file_.get(),
      fmt::format("{},{},{},{},{},{},{},{},{}\n", frame, name, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()));
  if (std::fflush(file_.get()) != 0)
    throw RunError(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
}

}  // namespace supple
