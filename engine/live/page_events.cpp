#include "live/page_events.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "output/files/json_text.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

// Returns the group of a control on the page, and its name there: the name of the body or collider and the path in it,
// or the scene's table and the key.
std::pair<std::string, std::string> place_of(const std::string& path) {
  for (const std::string list : {"body.", "collider."}) {
    if (!path.starts_with(list)) continue;
    const std::size_t end = path.find('.', list.size());
    return {path.substr(list.size(), end - list.size()), path.substr(end + 1)};
  }
  const std::size_t dot = path.find('.');
  return dot == std::string::npos ? std::pair(std::string("scene"), path)
                                  : std::pair(path.substr(0, dot), path.substr(dot + 1));
}

Json bound(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json controls_json(const std::vector<LiveKey>& keys) {
  Json list = Json::array();
  for (const auto& [key, cost] : keys) {
    const auto [group, name] = place_of(key.path);
    list.push_back({{"path", key.path},
                    {"group", group},
                    {"name", name},
                    {"type", key.type},
                    {"unit", key.unit},
                    {"allowed", key.allowed},
                    {"meaning", key.meaning},
                    {"cost", cost.text()},
                    {"value", key.value},
                    {"low", bound(key.range.lowest)},
                    {"high", bound(key.range.highest)},
                    {"open_low", key.range.open_below},
                    {"words", key.words}});
  }
  return list;
}

}  // namespace

void PageEvents::tell_scene(const std::string& record) {
  const SceneDef& scene = world_.script().scene();
  Json bodies = Json::array(), fields = Json::array();
  for (const Body& body : world_.bodies()) {
    const TetMesh& mesh = body.description.mesh;
    bodies.push_back(
        {{"name", body.def.name}, {"vertices", mesh.rest.rows()}, {"elements", elements_of(body.description)}});
  }
  for (const std::string& name : all_names<FieldQuantity>())
    if (name != name_of(FieldQuantity::distance)) fields.push_back(name);  // it needs another run
  const std::pair<const char*, Json> all[] = {{"title", scene.title.empty() ? scene.name : scene.title},
                                              {"scene", scene.name},
                                              {"fps", static_cast<double>(scene.fps)},
                                              {"width", scene.output.width},
                                              {"height", scene.output.height},
                                              {"bodies", bodies},
                                              {"fields", fields},
                                              {"record", record.empty() ? Json(nullptr) : Json(record)}};
  for (const auto& [name, value] : all) log_.keep_silently(name, json_text(value));
}

void PageEvents::tell_state(const PageState& state) {
  Json pins = Json::array();
  for (const LiveGrab& pin : state.pins) pins.push_back({{"body", pin.body}, {"name", pin.name}});
  const Json json = {{"paused", state.paused},
                     {"speed", state.speed},
                     {"frame", state.frames},
                     {"first", 0},
                     {"last", state.frames},
                     {"field", state.field},
                     {"wireframe", state.wireframe},
                     {"marks", state.marks},
                     {"keeps_rate", state.keeps_rate},
                     {"own_view", state.own_view},
                     {"pins", pins},
                     {"grabbed", state.grabbed.empty() ? Json(nullptr) : Json(state.grabbed)}};
  log_.keep("state", json_text(json));
}

void PageEvents::tell_controls() {
  std::vector<LiveKey> now = world_.script().live(world_.frames());
  for (const LiveGrab& grab : world_.script().edits().grabs) {  // the page has other ways to move these
    const std::string prefix = fmt::format("body.{}.handles.{}.", grab.body, grab.name);
    std::erase_if(now, [&prefix](const LiveKey& key) { return key.key.path.starts_with(prefix); });
  }
  const auto path_of = [](const LiveKey& key) { return key.key.path; };
  const bool same_keys = std::ranges::equal(now, controls_, {}, path_of, path_of);
  log_.keep_silently("controls", json_text(controls_json(now)));
  for (std::size_t i = 0; i < now.size() && same_keys; ++i) {
    if (now[i].key.value != controls_[i].key.value)
      log_.add("value", json_text(Json{{"path", now[i].key.path}, {"value", now[i].key.value}}));
  }
  if (!same_keys) log_.add("controls", json_text(controls_json(now)));
  controls_ = std::move(now);
}

void PageEvents::tell_words(const std::vector<std::string>& words) {
  const std::string text = json_text(Json(words));
  if (text == words_) return;
  words_ = text;
  log_.keep("words", text);
}

void PageEvents::tell_frame(const FrameRow& row, double rate, double picture_ms) {
  double error = 0, motion = 0;
  int iterations = 0;
  bool unsolved = false;
  for (const BodyRow& body : row.bodies) {
    error = std::max(error, body.error_estimate);
    motion = std::max(motion, body.motion_estimate);
    iterations += body.iterations;
    unsolved = unsolved || body.unsolved;
  }
  const Json json = {{"frame", row.frame + 1},
                     {"time", row.time_s},
                     {"ms", row.step_ms},
                     {"change_ms", row.change_ms.value_or(0)},
                     {"draw_ms", row.draw_ms.value_or(0) + picture_ms},
                     {"iterations", iterations},
                     {"error", error},
                     {"motion", motion},
                     {"rate", rate},
                     {"unsolved", unsolved}};
  log_.add("frame", json_text(json));
}

void PageEvents::say(const std::string& text) { log_.add("say", json_text(Json{{"text", text}})); }

void PageEvents::tell_end(const std::string& text) { log_.keep("end", json_text(Json{{"text", text}})); }

}  // namespace supple
