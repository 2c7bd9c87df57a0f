#include "film/record/checkpoint.h"

#include <fmt/core.h>

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

constexpr std::string_view signature = "supple checkpoint 4\n";

void append(std::string& bytes, const Positions& rows) {
  bytes.append(reinterpret_cast<const char*>(rows.data()), sizeof(double) * static_cast<std::size_t>(rows.size()));
}

void append_number(std::string& bytes, std::uint64_t number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

// Reads a file's content piece by piece from its beginning.
class Reader {
 public:
  Reader(const std::string& bytes, std::string source) : bytes_(bytes), source_(std::move(source)) {}

  std::string_view take(std::size_t count) {
    if (count > bytes_.size() - at_) fail();
    at_ += count;
    return std::string_view(bytes_).substr(at_ - count, count);
  }
  std::uint64_t number() {
    std::uint64_t value = 0;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  Positions rows(std::size_t count) {
    if (count > (bytes_.size() - at_) / (3 * sizeof(double))) fail();
    const std::string_view from = take(3 * sizeof(double) * count);
    Positions result(static_cast<Eigen::Index>(count), 3);
    std::memcpy(result.data(), from.data(), from.size());
    return result;
  }
  [[noreturn]] void fail() const {
    throw InputError(source_, "is damaged, or not a checkpoint of this version; start anew without --resume");
  }

 private:
  const std::string& bytes_;
  std::string source_;
  std::size_t at_ = 0;
};

}  // namespace

std::string checkpoint_bytes(const WorldState& checkpoint, const std::string& identity) {
  Json head = {{"identity", parsed_json<Json>(identity)}, {"frames", checkpoint.frames}, {"bodies", Json::array()}};
  for (const State& body : checkpoint.bodies) {
    Json holds = Json::array();
    for (const char held : body.anchors.holds) holds.push_back(held != 0);
    head["bodies"].push_back({{"vertices", body.x.rows()},
                              {"handled", body.anchors.points.rows()},
                              {"handles", body.anchors.centers.size()},
                              {"holds", holds},
                              {"time_s", body.time},
                              {"memory_bytes", bytes_of(body.memory).size()}});
    if (!body.flow.empty()) head["bodies"].back()["flow_bytes"] = bytes_of(body.flow).size();
    if (const std::string bounces = bytes_of(body.bounces); !bounces.empty())
      head["bodies"].back()["bounce_bytes"] = bounces.size();
  }
  const std::string text = exact_json_text(head);
  std::string bytes(signature);
  append_number(bytes, text.size());
  bytes += text;
  for (const State& body : checkpoint.bodies) {
    append(bytes, body.x);
    append(bytes, body.v);
    append(bytes, body.anchors.points);
    for (const Vec3& center : body.anchors.centers) append(bytes, center.transpose());
    bytes += bytes_of(body.memory);
    bytes += bytes_of(body.flow);
    bytes += bytes_of(body.bounces);
  }
  append_number(bytes, hash_text(bytes));
  return bytes;
}

namespace {

void check_identity(const Json& then, const std::string& now, const std::filesystem::path& path) {
  const std::vector<std::string> differences = json_differences(exact_json_text(then), now);
  if (differences.empty()) return;
  std::string list;
  for (const std::string& difference : differences) list += "\n  " + difference;
  throw InputError(path.string(),
                   fmt::format("is of another film than this one; the checkpoint says, and now it is:{}", list));
}

State read_body(const Json& body, Reader& reader) {
  State state;
  state.x = reader.rows(body.at("vertices"));
  state.v = reader.rows(body.at("vertices"));
  state.time = body.at("time_s");
  state.anchors.points = reader.rows(body.at("handled"));
  const Positions centers = reader.rows(body.at("handles"));
  for (Eigen::Index h = 0; h < centers.rows(); ++h) state.anchors.centers.push_back(centers.row(h).transpose());
  const std::optional<SolverMemory> memory = memory_from(reader.take(body.at("memory_bytes")), state.x.rows());
  if (!memory) reader.fail();
  state.memory = *memory;
  std::optional<Flow> flow = flow_from(reader.take(body.value("flow_bytes", std::size_t(0))));
  if (!flow) reader.fail();
  state.flow = *std::move(flow);
  std::optional<Bounces> bounces = bounces_from(reader.take(body.value("bounce_bytes", std::size_t(0))));
  if (!bounces) reader.fail();
  state.bounces = *std::move(bounces);
  for (const Json& held : body.at("holds")) state.anchors.holds.push_back(held.get<bool>());
  return state;
}

// Reads a checkpoint whose identity is the same but for values of these keys.
WorldState read_except(const std::filesystem::path& path, Json identity, std::initializer_list<const char*> ignored) {
  const std::string bytes = read_file(path);
  Reader reader(bytes, path.string());
  if (bytes.size() < signature.size() + 16 || reader.take(signature.size()) != signature) reader.fail();
  std::uint64_t hash = 0;
  std::memcpy(&hash, bytes.data() + bytes.size() - sizeof hash, sizeof hash);
  if (hash != hash_bytes(bytes.data(), bytes.size() - sizeof hash)) reader.fail();
  WorldState checkpoint;
  try {
    const Json head = parsed_json<Json>(reader.take(reader.number()));
    Json then = head.at("identity");
    for (const char* key : ignored) {
      then.erase(key);
      identity.erase(key);
    }
    check_identity(then, exact_json_text(identity), path);
    checkpoint.frames = head.at("frames");
    for (const Json& body : head.at("bodies")) checkpoint.bodies.push_back(read_body(body, reader));
  } catch (const Json::exception&) {  // the hash is right, so the file was written like this
    reader.fail();
  }
  return checkpoint;
}

}  // namespace

WorldState read_checkpoint(const std::filesystem::path& path, const std::string& identity) {
  return read_except(path, parsed_json<Json>(identity), {});
}

WorldState read_motion_checkpoint(const std::filesystem::path& path, const std::string& identity) {
  return read_except(path, parsed_json<Json>(identity), {"images", "gl", "vtu"});
}

}  // namespace supple
