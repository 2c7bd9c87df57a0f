#include "geometry/files/vertex_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>
#include <system_error>

#include "base/error.h"
#include "base/hash.h"
#include "base/read_file.h"
#include "base/text.h"
#include "geometry/files/number_words.h"

namespace supple {
namespace {

constexpr std::uintmax_t most_motion_bytes = 4'000'000'000;
constexpr std::size_t number_bytes = 4;  // of an integer or a number in single precision

std::uint32_t word_at(const std::string& bytes, std::size_t at, std::endian order) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < number_bytes; ++i) {
    const std::size_t place = order == std::endian::big ? at + i : at + number_bytes - 1 - i;
    value = value << 8 | static_cast<unsigned char>(bytes[place]);
  }
  return value;
}

std::int64_t integer_at(const std::string& bytes, std::size_t at, std::endian order) {
  return std::bit_cast<std::int32_t>(word_at(bytes, at, order));
}

// Reads the frames that stand one after the other from a place of the file on.
std::vector<Positions> frames_from(const std::string& bytes, std::size_t at, std::int64_t frames, std::int64_t points,
                                   std::endian order, const std::string& name) {
  std::vector<Positions> result;
  for (std::int64_t f = 0; f < frames; ++f) {
    Positions& places = result.emplace_back(points, 3);
    for (Eigen::Index v = 0; v < points; ++v)
      for (int k = 0; k < 3; ++k, at += number_bytes)
        places(v, k) = double(std::bit_cast<float>(word_at(bytes, at, order)));
    if (!places.allFinite()) throw InputError(name, fmt::format("is damaged: a number of frame {} is not finite", f));
  }
  return result;
}

[[noreturn]] void refuse_size(const std::string& name, std::uint64_t has, std::int64_t frames, std::int64_t points,
                              std::uint64_t wanted) {
  throw InputError(name, fmt::format("is {}: it holds {} bytes, and {} frames of {} points need {}",
                                     has < wanted ? "cut short" : "damaged", has, frames, points, wanted));
}

void check_counts(const std::string& name, std::int64_t frames, std::int64_t points) {
  if (frames >= 1 && points >= 1 && frames <= (1 << 24) && points <= (1 << 28)) return;
  throw InputError(name,
                   fmt::format("tells of {} frames of {} points: at least one of each is needed", frames, points));
}

// Reads a PC2 point cache. After the frames that the header counts, there may be a part of one more, left by a run that
// was stopped.
std::vector<Positions> read_pc2(const std::filesystem::path& path) {
  constexpr std::size_t header = 32, version_at = 12, points_at = 16, frames_at = 28;
  const std::string name = path.string(), bytes = read_file(path, most_motion_bytes);
  if (bytes.size() < header) throw InputError(name, "is cut short: a PC2 point cache begins with a header of 32 bytes");
  if (std::memcmp(bytes.data(), "POINTCACHE2", version_at) != 0)
    throw InputError(name, "is no PC2 point cache: it does not begin with 'POINTCACHE2'");
  const std::int64_t version = integer_at(bytes, version_at, std::endian::little);
  if (version != 1) {
    const bool swapped = integer_at(bytes, version_at, std::endian::big) == 1;
    throw InputError(name, swapped ? std::string("has its bytes in the other order: PC2 point caches are little-endian")
                                   : fmt::format("is a PC2 point cache of version {}: must be 1", version));
  }
  const std::int64_t points = integer_at(bytes, points_at, std::endian::little),
                     frames = integer_at(bytes, frames_at, std::endian::little);
  check_counts(name, frames, points);
  const std::uint64_t frame = 3 * number_bytes * std::uint64_t(points), wanted = header + frame * std::uint64_t(frames);
  if (bytes.size() < wanted || bytes.size() - wanted > frame) refuse_size(name, bytes.size(), frames, points, wanted);
  return frames_from(bytes, header, frames, points, std::endian::little, name);
}

std::uint64_t mdd_bytes(std::int64_t frames, std::int64_t points) {
  return number_bytes * (2 + std::uint64_t(frames) + 3 * std::uint64_t(frames) * std::uint64_t(points));
}

std::vector<Positions> read_mdd(const std::filesystem::path& path) {
  constexpr std::size_t header = 8;
  const std::string name = path.string(), bytes = read_file(path, most_motion_bytes);
  if (bytes.size() < header) throw InputError(name, "is cut short: an MDD point cache begins with two counts");
  const auto counts = [&](std::endian order) {
    return std::pair(integer_at(bytes, 0, order), integer_at(bytes, number_bytes, order));
  };
  const auto [frames, points] = counts(std::endian::big);
  const auto [swapped_frames, swapped_points] = counts(std::endian::little);
  const auto is_plausible = [](std::int64_t f, std::int64_t p) {
    return f >= 1 && p >= 1 && f <= (1 << 24) && p <= (1 << 28);
  };
  const bool fits = is_plausible(frames, points) && mdd_bytes(frames, points) == bytes.size();
  if (!fits && is_plausible(swapped_frames, swapped_points) &&
      mdd_bytes(swapped_frames, swapped_points) == bytes.size())
    throw InputError(name, "has its bytes in the other order: MDD point caches are big-endian");
  check_counts(name, frames, points);
  if (!fits) refuse_size(name, bytes.size(), frames, points, mdd_bytes(frames, points));
  return frames_from(bytes, header + number_bytes * std::size_t(frames), frames, points, std::endian::big, name);
}

// Returns the number that stands for the '*' of a series in a file's name; nothing where the name is not of the series.
std::optional<long long> number_in_series(const std::string& pattern, const std::string& name) {
  const std::size_t star = pattern.find('*');
  const std::string before = pattern.substr(0, star), after = pattern.substr(star + 1);
  if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) return {};
  const std::string digits = name.substr(before.size(), name.size() - before.size() - after.size());
  long long number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || number < 0) return {};
  return number;
}

std::map<long long, std::filesystem::path> files_of_series(const std::filesystem::path& pattern) {
  std::map<long long, std::filesystem::path> files;
  const std::filesystem::path folder = pattern.parent_path().empty() ? "." : pattern.parent_path();
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const auto number = number_in_series(pattern.filename().string(), entry->path().filename().string());
    if (!number) continue;
    const auto [at, is_new] = files.emplace(*number, entry->path());
    if (!is_new)
      throw InputError(pattern.string(),
                       fmt::format("has two files of the number {}: '{}' and '{}'", *number,
                                   at->second.filename().string(), entry->path().filename().string()));
  }
  return files;
}

bool is_series(const std::filesystem::path& path) { return path.filename().string().find('*') != std::string::npos; }

std::vector<Positions> read_series(const std::filesystem::path& pattern, std::filesystem::path& first) {
  const std::string name = pattern.string();
  if (pattern.extension() != ".obj") throw InputError(name, "a series must be of .obj files");
  const auto files = files_of_series(pattern);
  if (files.empty()) throw InputError(name, "there is no such file: the '*' stands for a number, such as 0001");
  first = files.begin()->second;
  const long long step = files.size() > 1 ? std::next(files.begin())->first - files.begin()->first : 1;
  long long expected = files.begin()->first;
  std::vector<Positions> frames;
  for (const auto& [number, file] : files) {
    if (number != expected) throw InputError(name, fmt::format("the file of number {} is missing", expected));
    expected = number + step;
    frames.push_back(read_obj_vertices(file));
    if (frames.back().rows() == frames.front().rows()) continue;
    throw InputError(file.string(),
                     fmt::format("has {} vertices, and '{}' has {}: all files of a series need as many",
                                 frames.back().rows(), first.filename().string(), frames.front().rows()));
  }
  return frames;
}

std::filesystem::path cache_of_run(const std::filesystem::path& run, const std::string& body) {
  const std::filesystem::path folder = run / "motion", cache = folder / (body + ".pc2");
  std::error_code error;
  if (std::filesystem::exists(cache, error)) return cache;
  std::vector<std::string> names;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".pc2") names.push_back(entry->path().stem().string());
  std::sort(names.begin(), names.end());
  if (names.empty()) throw InputError(run.string(), "is no folder of a run: it has no point caches in 'motion'");
  throw InputError(run.string(), fmt::format("has no motion of a body '{}': there is {}{}", body, word_list(names),
                                             did_you_mean(body, names)));
}

}  // namespace

bool is_motion_there(const std::filesystem::path& path) {
  std::error_code error;
  if (!is_series(path)) return std::filesystem::exists(path, error);
  try {
    return !files_of_series(path).empty();
  } catch (const InputError&) {
    return true;  // two files have one number: read_vertex_motion() says so
  }
}

// Only the vertices are read: reader/checked_obj.cpp checks all of a surface's file.
Positions read_obj_vertices(const std::filesystem::path& path) {
  std::istringstream text(read_text(path));
  std::vector<Vec3> places;
  int number = 1;
  for (std::string line, word; std::getline(text, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    if (!(words >> word) || word != "v") continue;
    Vec3& place = places.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const auto coordinate = words >> word ? number_of<double>(word) : std::nullopt;
      if (!coordinate || !std::isfinite(*coordinate))
        throw InputError(
            {Problem{{path.string(), number}, "a vertex needs three coordinates that are finite numbers"}});
      place[k] = *coordinate;
    }
  }
  if (places.empty()) throw InputError(path.string(), "has no vertices");
  Positions result(Eigen::Index(places.size()), 3);
  for (std::size_t v = 0; v < places.size(); ++v) result.row(Eigen::Index(v)) = places[v].transpose();
  return result;
}

VertexMotion read_vertex_motion(const std::filesystem::path& path, const std::string& body) {
  VertexMotion motion{{}, path};
  std::error_code error;
  if (is_series(path)) {
    motion.frames = read_series(path, motion.file);
    return motion;
  }
  if (std::filesystem::is_directory(path, error)) motion.file = cache_of_run(path, body);
  if (motion.file.extension() == ".pc2") {
    motion.frames = read_pc2(motion.file);
  } else if (motion.file.extension() == ".mdd") {
    motion.frames = read_mdd(motion.file);
  } else {
    throw InputError(path.string(), fmt::format("is no motion: must be {}", motion_kinds));
  }
  return motion;
}

SourceFile source_of(const VertexMotion& motion) {
  std::uint64_t hash = 0;
  for (const Positions& frame : motion.frames)
    hash = hash_bytes(frame.data(), sizeof(double) * std::size_t(frame.size()), hash);
  return {motion.file, hash};
}

}  // namespace supple
