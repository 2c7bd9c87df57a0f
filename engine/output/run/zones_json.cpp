#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/read_file.h"
#include "output/files/json_text.h"
#include "output/run/zones.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;
using ByRepeat = std::vector<std::vector<double>>;

constexpr const char* format_name = "supple zones 1";

Json rounded(const std::vector<double>& list) {
  Json json = Json::array();
  for (const double ms : list) json.push_back(rounded_ms(ms));
  return json;
}

Json rounded(const ByRepeat& times) {
  Json json = Json::array();
  for (const std::vector<double>& frames : times) json.push_back(rounded(frames));
  return json;
}

Json json_of(const ProfiledRun& run) {
  Json json = {{"scene", run.scene},          {"frames", run.frames},     {"fps", run.fps},
               {"threads", run.threads},      {"pictures", run.pictures}, {"cpu", run.cpu},
               {"kernels", run.kernels},      {"version", run.version},   {"build", run.build},
               {"state_hash", run.state_hash}};
  json["meshes"] = Json::array();
  for (const auto& [body, hash] : run.meshes) json["meshes"].push_back({{"body", body}, {"xxh64", hash}});
  json["replay"] = run.replay_json;
  json["scene_resolved"] = json_if_valid<Json>(run.scene_json);
  return json;
}

ProfiledRun run_of(const Json& json) {
  ProfiledRun run;
  json.at("scene").get_to(run.scene);
  json.at("frames").get_to(run.frames);
  json.at("fps").get_to(run.fps);
  json.at("threads").get_to(run.threads);
  json.at("pictures").get_to(run.pictures);
  json.at("cpu").get_to(run.cpu);
  json.at("kernels").get_to(run.kernels);
  json.at("version").get_to(run.version);
  json.at("build").get_to(run.build);
  json.at("state_hash").get_to(run.state_hash);
  for (const Json& mesh : json.at("meshes"))
    run.meshes.emplace_back(mesh.at("body").get<std::string>(), mesh.at("xxh64").get<std::string>());
  json.at("replay").get_to(run.replay_json);
  run.scene_json = exact_json_text(json.at("scene_resolved"));
  return run;
}

ByRepeat times_of(const Json& json, const ZoneProfile& profile, const std::string& source) {
  auto times = json.get<ByRepeat>();
  bool fits = static_cast<int>(times.size()) == profile.repeats;
  for (const std::vector<double>& frames : times) fits &= static_cast<int>(frames.size()) == profile.run.frames;
  if (!fits) throw InputError(source, "a zone does not have one time for each repeat and frame");
  return times;
}

ZoneProfile profile_of(const Json& json, const std::string& source) {
  if (json.at("format") != format_name) throw InputError(source, fmt::format("is not of the format '{}'", format_name));
  ZoneProfile profile;
  profile.run = run_of(json.at("run"));
  json.at("repeats").get_to(profile.repeats);
  for (const Json& row : json.at("setup"))
    profile.setup.push_back({row.at("zone").get<std::string>(), row.at("ms").get<std::vector<double>>()});
  for (const Json& row : json.at("zones")) {
    profile.zones.push_back({row.at("thread").get<std::string>(), row.at("zone").get<std::string>(),
                             row.at("calls_a_frame").get<double>(), times_of(row.at("ms"), profile, source),
                             times_of(row.at("self_ms"), profile, source)});
  }
  if (profile.zones.empty() || profile.zones.front().path != "frame")
    throw InputError(source, "has no zones of frames");
  return profile;
}

}  // namespace

std::string zones_json(const ZoneProfile& profile) {
  Json json = {{"format", format_name}, {"run", json_of(profile.run)}, {"repeats", profile.repeats}};
  json["setup"] = Json::array();
  for (const SetupTimes& row : profile.setup) json["setup"].push_back({{"zone", row.name}, {"ms", rounded(row.ms)}});
  json["zones"] = Json::array();
  for (const ZoneTimes& zone : profile.zones) {
    json["zones"].push_back({{"thread", zone.thread},
                             {"zone", zone.path},
                             {"calls_a_frame", zone.calls},
                             {"ms", rounded(zone.ms)},
                             {"self_ms", rounded(zone.self_ms)}});
  }
  // File names need not be UTF-8, but JSON must be.
  return json_text(json) + "\n";
}

ZoneProfile read_zones(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  try {
    return profile_of(parsed_json<Json>(text), path.string());
  } catch (const nlohmann::json::exception&) {
    throw InputError(path.string(), "is not a zones.json as this version writes it");
  }
}

}  // namespace supple
