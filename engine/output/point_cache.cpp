#include "output/point_cache.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace supple {
namespace {

// The header of a PC2 file, little-endian.
struct Header {
  char signature[12];
  std::int32_t version;
  std::int32_t points;
  float start_frame;
  float sample_rate;
  std::int32_t samples;
};
static_assert(sizeof(Header) == 32);

}  // namespace

PointCacheWriter::PointCacheWriter(const std::filesystem::path& path, int points, int kept_frames)
    : path_(path), file_(std::fopen(path.c_str(), kept_frames > 0 ? "r+b" : "wb")), points_(points) {
  if (!file_) fail(kept_frames > 0 ? "be opened" : "be created");
  if (kept_frames > 0) {
    go_on_behind(kept_frames);
    return;
  }
  // One sample a frame: the rate counts frames of the film between samples.
  const Header header{{'P', 'O', 'I', 'N', 'T', 'C', 'A', 'C', 'H', 'E', '2', '\0'}, 1, points, 0.0f, 1.0f, 0};
  if (std::fwrite(&header, sizeof header, 1, file_.get()) != 1) fail("be written");
}

void PointCacheWriter::go_on_behind(int frames) {
  Header header{};
  const auto size = static_cast<std::int64_t>(sizeof header + sizeof(float) * 3 * std::size_t(points_) * frames);
  if (std::fread(&header, sizeof header, 1, file_.get()) != 1 || header.points != points_ || header.samples < frames)
    throw RunError(fmt::format("{}: does not have the {} frames to go on from", path_.string(), frames));
  header.samples = frames_ = frames;
  if (std::fseek(file_.get(), 0, SEEK_SET) != 0 || std::fwrite(&header, sizeof header, 1, file_.get()) != 1 ||
      std::fflush(file_.get()) != 0 || ftruncate(fileno(file_.get()), size) != 0 ||
      std::fseek(file_.get(), 0, SEEK_END) != 0) {
    fail("be written");
  }
}

void PointCacheWriter::add(const Positions& points) {
  SUPPLE_CHECK(points.rows(), ==, points_);
  const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> rows = points.cast<float>();
  if (std::fwrite(rows.data(), sizeof(float), rows.size(), file_.get()) != std::size_t(rows.size())) fail("be written");
  const std::int32_t samples = ++frames_;
  if (std::fseek(file_.get(), offsetof(Header, samples), SEEK_SET) != 0 ||
      std::fwrite(&samples, sizeof samples, 1, file_.get()) != 1 || std::fseek(file_.get(), 0, SEEK_END) != 0 ||
      std::fflush(file_.get()) != 0) {
    fail("be written");
  }
}

void PointCacheWriter::fail(const char* doing) const {
  throw RunError(fmt::format("{}: cannot {}: {}", path_.string(), doing, std::strerror(errno)));
}

}  // namespace supple
