#include "film/record/state_record.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/read_file.h"
#include "output/files/json_text.h"
#include "output/run/json_difference.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* format_name = "supple record 1";
constexpr std::string_view first_bytes = "{\"format\":\"supple record ";  // of all versions

// Holds the record of one vertex. Vertices are stored in the order of the input file.
struct VertexRecord {
  std::array<float, 3> position;  // [m]
  std::uint32_t hash;             // of position and velocity
};
static_assert(sizeof(VertexRecord) == 16);

std::vector<VertexRecord> vertex_records(const Model& model, const State& state) {
  std::vector<VertexRecord> records(model.vertices);
  for (int v = 0; v < model.vertices; ++v) {
    double both[6];
    for (int c = 0; c < 3; ++c) {
      both[c] = state.x(v, c);
      both[3 + c] = state.v(v, c);
    }
    VertexRecord& record = records[model.input_of[v]];
    for (int c = 0; c < 3; ++c) record.position[c] = static_cast<float>(both[c]);
    record.hash = static_cast<std::uint32_t>(hash_bytes(both, sizeof both));
  }
  return records;
}

std::size_t bytes_of_frame(const RecordHead& head) {
  std::size_t bytes = 0;
  for (const RecordHead::Body& body : head.bodies) bytes += sizeof(VertexRecord) * body.vertices;
  return bytes;
}

std::string line_of(const RecordHead& head) {
  Json bodies = Json::array();
  for (const RecordHead::Body& body : head.bodies) bodies.push_back({{"name", body.name}, {"vertices", body.vertices}});
  const Json json = {{"format", format_name},
                     {"program", head.program},
                     {"kernels", head.kernels},
                     {"film", parsed_json<Json>(head.film)},
                     {"bodies", bodies}};
  return exact_json_text(json) + '\n';
}

// Returns the offset in the file at which the frames after the first `frames` begin.
std::size_t bytes_behind(const RecordHead& head, int frames) {
  return line_of(head).size() + bytes_of_frame(head) * static_cast<std::size_t>(frames);
}

// Reads the first line, but no more of it than the head of a record can have: a file that is not a record need not have
// lines.
std::string first_line(std::istream& file) {
  constexpr std::size_t most_bytes = 32'000'000;
  std::string line;
  for (int c = file.get(); c != std::istream::traits_type::eof() && c != '\n' && line.size() < most_bytes;
       c = file.get())
    line += char(c);
  return line;
}

RecordHead read_head(std::istream& file, const std::string& source) {
  RecordHead head;
  try {
    const Json json = parsed_json<Json>(first_line(file));
    if (json.at("format") != format_name) throw InputError(source, "is a record of another version");
    head.program = json.at("program");
    head.kernels = json.at("kernels");
    head.film = exact_json_text(json.at("film"));
    for (const Json& body : json.at("bodies")) head.bodies.push_back({body.at("name"), body.at("vertices")});
  } catch (const nlohmann::json::exception&) {
    throw InputError(source, "is not a record that --record made");
  }
  return head;
}

std::string names_of(const RecordHead& head) {
  std::string names;
  for (const RecordHead::Body& body : head.bodies)
    names += fmt::format("{}{} ({} vertices)", names.empty() ? "" : ", ", body.name, body.vertices);
  return names;
}

}  // namespace

bool may_be_recorded_over(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return true;
  std::ifstream file(path, std::ios::binary);
  if (!file) return false;
  std::string begin(first_bytes.size(), '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return file.gcount() == 0 || begin == first_bytes;
}

void check_kept_record(const std::filesystem::path& path, const RecordHead& head, int kept_frames) {
  std::ifstream file(path, std::ios::binary);
  const std::string first = first_line(file);
  if (file && first + '\n' != line_of(head))
    throw InputError(path.string(), "is not the record of this film's first frames");
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size < bytes_behind(head, kept_frames))
    throw InputError(path.string(), fmt::format("does not have the first {} frames of the film; record from the first "
                                                "one on, or leave --record out",
                                                kept_frames));
}

StateRecorder::StateRecorder(const std::filesystem::path& path, const RecordHead& head, int kept_frames)
    : path_(path), file_(std::fopen(path.c_str(), kept_frames > 0 ? "r+b" : "wb")) {
  if (!file_) fail();
  if (kept_frames > 0) {
    check_kept_record(path, head, kept_frames);
    const auto size = static_cast<off_t>(bytes_behind(head, kept_frames));
    if (ftruncate(fileno(file_.get()), size) != 0 || std::fseek(file_.get(), 0, SEEK_END) != 0) fail();
  } else {
    const std::string line = line_of(head);
    if (std::fwrite(line.data(), 1, line.size(), file_.get()) != line.size()) fail();
  }
}

void StateRecorder::fail() const {
  throw RunError(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
}

void StateRecorder::add(const Model& model, const State& state) {
  const std::vector<VertexRecord> records = vertex_records(model, state);
  if (std::fwrite(records.data(), sizeof(VertexRecord), records.size(), file_.get()) != records.size() ||
      std::fflush(file_.get()) != 0) {
    fail();
  }
}

StateVerifier::StateVerifier(const std::filesystem::path& path, const RecordHead& now, std::optional<double> tolerance,
                             int skipped_frames)
    : path_(path), file_(path, std::ios::binary), tolerance_(tolerance), first_frame_(skipped_frames) {
  const std::string source = path.string();
  check_regular_file(path);
  if (!file_) throw InputError(source, "cannot be read");
  head_ = read_head(file_, source);
  const bool same_program = head_.program == now.program && head_.kernels == now.kernels;
  if (!same_program && !tolerance_) {
    throw InputError(source,
                     fmt::format("was recorded by another build ({}, kernels {}; this is {}, kernels {}), which "
                                 "need not give the same bits; --tolerance 1e-6 compares positions",
                                 head_.program, head_.kernels, now.program, now.kernels));
  }
  if (names_of(head_) != names_of(now))
    throw InputError(source, fmt::format("is of other bodies: {}; this film has {}", names_of(head_), names_of(now)));
  for (const std::string& difference : json_differences(head_.film, now.film))
    remark_ +=
        fmt::format("{}{}", remark_.empty() ? "not the film that was recorded; then and now: " : "; ", difference);
  const auto begin = file_.tellg();
  std::error_code ignored;
  const std::size_t bytes = std::filesystem::file_size(path, ignored) - std::size_t(begin);
  recorded_frames_ = static_cast<int>(bytes / bytes_of_frame(head_));
  if (recorded_frames_ == 0) throw InputError(source, "holds no whole frame");
  if (const std::size_t rest = bytes % bytes_of_frame(head_); rest != 0) {
    throw InputError(source, fmt::format("is damaged: after {} whole frames of {} bytes there are {} bytes more",
                                         recorded_frames_, bytes_of_frame(head_), rest));
  }
  file_.seekg(begin + static_cast<std::streamoff>(bytes_of_frame(head_) * skipped_frames));
}

std::string StateVerifier::compare(int frame, const Model& model, const State& state) {
  const RecordHead::Body& body = head_.bodies[next_body_];
  next_body_ = (next_body_ + 1) % head_.bodies.size();
  if (frame >= recorded_frames_) return "";
  std::vector<VertexRecord> before(body.vertices);
  file_.read(reinterpret_cast<char*>(before.data()),
             static_cast<std::streamsize>(sizeof(VertexRecord) * before.size()));
  if (!file_) return fmt::format("frame {}: {} cannot be read any further", frame, path_.string());
  const std::vector<VertexRecord> now = vertex_records(model, state);
  for (int v = 0; v < body.vertices; ++v) {
    double squared = 0;
    for (int c = 0; c < 3; ++c) {
      const double d = double(now[v].position[c]) - double(before[v].position[c]);
      squared += d * d;
    }
    const double distance = std::sqrt(squared);
    furthest_ = std::max(furthest_, distance / model.size);
    if (tolerance_ ? !(distance <= *tolerance_ * model.size) : now[v].hash != before[v].hash) {
      return fmt::format("frame {}: body '{}' is not what was recorded; vertex {} is the first that differs, {}", frame,
                         body.name, v + 1,
                         distance > 0
                             ? fmt::format("by {:.2g} m ({:.1e} of the body's size)", distance, distance / model.size)
                             : std::string("in the last bits of its position or in its velocity"));
    }
  }
  return "";
}

bool StateVerifier::compared_any(int frames) const { return std::min(frames, recorded_frames_) > first_frame_; }

std::string StateVerifier::verdict(int frames) const {
  if (!compared_any(frames)) {
    return frames == first_frame_ ? "verified: nothing; the film was complete already"
                                  : "verified: nothing; the record ends before the frames of this run";
  }
  const int last = std::min(frames, recorded_frames_) - 1;
  const std::string how =
      tolerance_ ? fmt::format("within {:g} of the bodies' size (furthest: {:.1e})", *tolerance_, furthest_)
                 : std::string("the same to the last bit");
  const std::string end = frames == recorded_frames_
                              ? ""
                              : fmt::format("; the record has {} frames, the film {}", recorded_frames_, frames);
  return fmt::format("verified: frames {} to {} are {}{}", first_frame_, last, how, end);
}

}  // namespace supple
