#include "output/motion/force_file.h"

#include <fmt/core.h>

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <string>

#include "base/error.h"

namespace supple {
namespace {

// Describes the header, little-endian as all of the file.
struct ForceHeader {
  char signature[12];
  std::int32_t vertices;
};
constexpr char force_signature[12] = "CONTACTFRC1";

// Describes the force on one vertex.
struct Entry {
  std::int32_t vertex;
  float force[3];
};
static_assert(sizeof(ForceHeader) == 16 && sizeof(Entry) == 16);

std::optional<ForceHeader> header_of(std::ifstream& file) {
  ForceHeader header{};
  if (!file.read(reinterpret_cast<char*>(&header), sizeof header)) return std::nullopt;
  if (std::memcmp(header.signature, force_signature, sizeof force_signature) != 0 || header.vertices < 0)
    return std::nullopt;
  return header;
}

// Returns where the frames behind the header begin, and after them where the last whole one ends. At most `most` frames
// are looked for.
std::vector<std::int64_t> marks_of(std::ifstream& file, const std::filesystem::path& path, int vertices,
                                   std::size_t most) {
  std::error_code error;
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  std::vector<std::int64_t> marks = {sizeof(ForceHeader)};
  while (!error && marks.size() <= most) {
    std::int32_t count = 0;
    file.seekg(marks.back());
    if (!file.read(reinterpret_cast<char*>(&count), sizeof count) || count < 0 || count > vertices) break;
    const std::int64_t end = marks.back() + std::int64_t(sizeof count) + std::int64_t(sizeof(Entry)) * count;
    if (end > bytes) break;
    marks.push_back(end);
  }
  file.clear();
  return marks;
}

}  // namespace

bool force_file_has(const std::filesystem::path& path, int vertices, int frames) {
  std::ifstream file(path, std::ios::binary);
  const std::optional<ForceHeader> header = header_of(file);
  return header && header->vertices == vertices &&
         static_cast<int>(marks_of(file, path, vertices, std::size_t(frames)).size()) > frames;
}

Positions as_kept_forces(const Positions& forces) { return forces.cast<float>().cast<double>(); }

ForceFileWriter::ForceFileWriter(const std::filesystem::path& path, int vertices, int kept_frames)
    : path_(path), vertices_(vertices) {
  if (kept_frames > 0) {
    if (!force_file_has(path, vertices, kept_frames))
      throw RunError(
          fmt::format("{}: does not have the {} frames after which to continue", path.string(), kept_frames));
    std::ifstream file(path, std::ios::binary);
    const std::int64_t end = marks_of(file, path, vertices, std::size_t(kept_frames)).back();
    file_.reset(std::fopen(path.c_str(), "r+b"));
    if (!file_) fail("be opened");
    if (ftruncate(fileno(file_.get()), end) != 0 || std::fseek(file_.get(), 0, SEEK_END) != 0) fail("be written");
    return;
  }
  file_.reset(std::fopen(path.c_str(), "wb"));
  if (!file_) fail("be created");
  ForceHeader header{{}, vertices};
  std::memcpy(header.signature, force_signature, sizeof force_signature);
  if (std::fwrite(&header, sizeof header, 1, file_.get()) != 1) fail("be written");
}

void ForceFileWriter::add(const Positions& forces) {
  SUPPLE_CHECK(forces.rows(), ==, vertices_);
  std::vector<Entry> entries;
  for (Eigen::Index v = 0; v < forces.rows(); ++v) {
    const Eigen::RowVector3f force = forces.row(v).cast<float>();
    if (!force.isZero(0)) entries.push_back({static_cast<std::int32_t>(v), {force[0], force[1], force[2]}});
  }
  const auto count = static_cast<std::int32_t>(entries.size());
  const bool is_empty = entries.empty();  // nothing touches, and there is no memory to write from
  if (std::fwrite(&count, sizeof count, 1, file_.get()) != 1 ||
      (!is_empty && std::fwrite(entries.data(), sizeof(Entry), entries.size(), file_.get()) != entries.size()) ||
      std::fflush(file_.get()) != 0) {
    fail("be written");
  }
}

void ForceFileWriter::fail(const char* doing) const {
  throw RunError(fmt::format("{}: cannot {}: {}", path_.string(), doing, std::strerror(errno)));
}

ForceFileReader::ForceFileReader(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary) {
  if (!file_) refuse("cannot be read");
  const std::optional<ForceHeader> header = header_of(file_);
  if (!header) refuse("is not a file of contact forces");
  vertices_ = header->vertices;
  constexpr std::size_t all = 1u << 30;
  begins_ = marks_of(file_, path, vertices_, all);
  begins_.pop_back();
}

Positions ForceFileReader::frame(int index) {
  SUPPLE_CHECK(index, >=, 0);
  SUPPLE_CHECK(index, <, frames());
  std::int32_t count = 0, last = -1;
  file_.seekg(begins_[std::size_t(index)]);
  if (!file_.read(reinterpret_cast<char*>(&count), sizeof count) || count < 0 || count > vertices_)
    refuse(fmt::format("cannot be read at frame {}", index));
  std::vector<Entry> entries(static_cast<std::size_t>(count));
  if (!file_.read(reinterpret_cast<char*>(entries.data()), std::streamsize(sizeof(Entry)) * count))
    refuse(fmt::format("cannot be read at frame {}", index));
  Positions forces = Positions::Zero(vertices_, 3);
  for (const Entry& entry : entries) {
    if (entry.vertex <= last || entry.vertex >= vertices_)
      refuse(
          fmt::format("is damaged: frame {} has the vertex {}, and the body has {}", index, entry.vertex, vertices_));
    last = entry.vertex;
    forces.row(entry.vertex) << entry.force[0], entry.force[1], entry.force[2];
    if (!forces.row(entry.vertex).allFinite())
      refuse(fmt::format("is damaged: a force of frame {} is not finite", index));
  }
  return forces;
}

void ForceFileReader::refuse(const std::string& what) const { throw InputError(path_.string(), what); }

}  // namespace supple
