#include "live/control_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

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

}  // namespace

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

}  // namespace supple
