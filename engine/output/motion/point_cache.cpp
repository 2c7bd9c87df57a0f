#include "output/motion/point_cache.h"

#include <fmt/core.h>

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace supple {
namespace {

// Describes the header of a PC2 file, little-endian.
struct CacheHeader {
  char signature[12];
  std::int32_t version;
  std::int32_t points;
  float start_frame;
  float sample_rate;
  std::int32_t samples;
};
static_assert(sizeof(CacheHeader) == 32);
constexpr char cache_signature[12] = "POINTCACHE2";

// Holds one row for each vertex, as the file does.
using FilePoints = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

}  // namespace

bool point_cache_has(const std::filesystem::path& path, int points, int frames) {
  CacheHeader header{};
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return !error && file.read(reinterpret_cast<char*>(&header), sizeof header) && header.points == points &&
         header.samples >= frames && bytes >= sizeof header + 3 * sizeof(float) * std::uintmax_t(points) * frames;
}

Positions as_cached(const Positions& points) { return points.cast<float>().cast<double>(); }

PointCacheWriter::PointCacheWriter(const std::filesystem::path& path, int points, int kept_frames)
    : path_(path), file_(std::fopen(path.c_str(), kept_frames > 0 ? "r+b" : "wb")), points_(points) {
  if (!file_) fail(kept_frames > 0 ? "be opened" : "be created");
  if (kept_frames > 0) {
    continue_after(kept_frames);
    return;
  }
  // The file holds one sample for each frame: the rate counts frames of the film between samples.
  CacheHeader header{{}, 1, points, 0.0f, 1.0f, 0};
  std::memcpy(header.signature, cache_signature, sizeof cache_signature);
  if (std::fwrite(&header, sizeof header, 1, file_.get()) != 1) fail("be written");
}

void PointCacheWriter::continue_after(int frames) {
  CacheHeader header{};
  const auto size = static_cast<std::int64_t>(sizeof header + sizeof(float) * 3 * std::size_t(points_) * frames);
  if (!point_cache_has(path_, points_, frames))
    throw RunError(fmt::format("{}: does not have the {} frames after which to continue", path_.string(), frames));
  if (std::fread(&header, sizeof header, 1, file_.get()) != 1) fail("be read");
  header.samples = frames_ = frames;
  if (std::fseek(file_.get(), 0, SEEK_SET) != 0 || std::fwrite(&header, sizeof header, 1, file_.get()) != 1 ||
      std::fflush(file_.get()) != 0 || ftruncate(fileno(file_.get()), size) != 0 ||
      std::fseek(file_.get(), 0, SEEK_END) != 0) {
    fail("be written");
  }
}

void PointCacheWriter::add(const Positions& points) {
  SUPPLE_CHECK(points.rows(), ==, points_);
  const FilePoints rows = points.cast<float>();
  if (std::fwrite(rows.data(), sizeof(float), rows.size(), file_.get()) != std::size_t(rows.size())) fail("be written");
  const std::int32_t samples = ++frames_;
  if (std::fseek(file_.get(), offsetof(CacheHeader, samples), SEEK_SET) != 0 ||
      std::fwrite(&samples, sizeof samples, 1, file_.get()) != 1 || std::fseek(file_.get(), 0, SEEK_END) != 0 ||
      std::fflush(file_.get()) != 0) {
    fail("be written");
  }
}

void PointCacheWriter::fail(const char* doing) const {
  throw RunError(fmt::format("{}: cannot {}: {}", path_.string(), doing, std::strerror(errno)));
}

PointCacheReader::PointCacheReader(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary) {
  CacheHeader header;
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error || !file_) refuse("cannot be read");
  if (!file_.read(reinterpret_cast<char*>(&header), sizeof header) ||
      std::memcmp(header.signature, cache_signature, sizeof cache_signature) != 0)
    refuse("is not a PC2 point cache");
  if (header.version != 1) refuse(fmt::format("is of version {}; this program reads version 1", header.version));
  if (header.points < 0 || header.samples < 0)
    refuse(fmt::format("is damaged: its header says {} points and {} frames", header.points, header.samples));
  points_ = header.points;
  frames_ = header.samples;
  const std::uintmax_t frame = 3 * sizeof(float) * std::uintmax_t(points_);
  const std::uintmax_t told = sizeof header + frame * std::uintmax_t(frames_);
  if (bytes < told || bytes - told > frame) {
    refuse(fmt::format("is {}: it holds {} bytes, and {} frames of {} points need {}",
                       bytes < told ? "cut short" : "damaged", bytes, frames_, points_, told));
  }
}

Positions PointCacheReader::frame(int index) {
  SUPPLE_CHECK(index, >=, 0);
  SUPPLE_CHECK(index, <, frames_);
  FilePoints rows(points_, 3);
  const auto bytes = std::streamsize(sizeof(float)) * rows.size();
  file_.seekg(std::streamoff(sizeof(CacheHeader)) + bytes * index);
  if (!file_.read(reinterpret_cast<char*>(rows.data()), bytes))
    refuse(fmt::format("cannot be read at frame {}", index));
  if (!rows.allFinite()) refuse(fmt::format("is damaged: a number of frame {} is not finite", index));
  return rows.cast<double>();
}

void PointCacheReader::refuse(const std::string& what) const { throw InputError(path_.string(), what); }

}  // namespace supple
