#include "output/pose_table.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "base/console.h"
#include "base/error.h"
#include "base/trace.h"

namespace supple {

namespace {

// The rows of the first frames, heading included.
std::string first_rows(const std::filesystem::path& path, int frames) {
  std::ifstream file(path);
  std::string kept;
  for (std::string line; std::getline(file, line);) {
    if (!kept.empty() && std::atoi(line.c_str()) >= frames) break;
    kept += line + '\n';
  }
  return kept;
}

}  // namespace

PoseTableWriter::PoseTableWriter(const std::filesystem::path& path, int kept_frames)
    : path_(path), file_(std::fopen(path.c_str(), kept_frames > 0 ? "r+" : "w")) {
  const auto check = [this](bool done) {
    if (!done) throw RunError(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
  };
  check(file_ != nullptr);
  if (kept_frames > 0) {
    const auto size = static_cast<off_t>(first_rows(path, kept_frames).size());
    check(ftruncate(fileno(file_.get()), size) == 0 && std::fseek(file_.get(), 0, SEEK_END) == 0);
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
