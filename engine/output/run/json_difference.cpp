#include "output/run/json_difference.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "output/files/json_text.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& value) { return json_text(value); }

std::string shortened(const std::string& text) {
  return text.size() > 60 ? fmt::format("{}...", text.substr(0, 57)) : text;
}

std::string name_of(const Json& element) {
  const bool named = element.is_object() && element.contains("name") && element["name"].is_string();
  return named ? element["name"].get<std::string>() : "";
}

// Lists members and elements by the last word of their path.
using Children = std::vector<std::pair<std::string, const Json*>>;

Children children_of(const Json& value) {
  Children children;
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) children.emplace_back(key, &member);
    return children;
  }
  std::map<std::string, int> uses;
  for (const Json& element : value) ++uses[name_of(element)];
  for (const Json& element : value) {
    const std::string name = name_of(element);
    children.emplace_back(name.empty() || uses[name] > 1 ? fmt::format("{}", children.size()) : name, &element);
  }
  return children;
}

const Json* find(const Children& children, const std::string& word) {
  const auto found = std::ranges::find(children, word, &Children::value_type::first);
  return found == children.end() ? nullptr : found->second;
}

bool has_parts(const Json& value) {
  return value.is_object() || (value.is_array() && !value.empty() && !value.front().is_primitive());
}

void compare(const Json& a, const Json& b, const std::string& path, std::vector<JsonDifference>& found) {
  if (a == b) return;
  if (!has_parts(a) || !has_parts(b) || a.is_array() != b.is_array()) {
    found.push_back({path, text_of(a), text_of(b)});
    return;
  }
  const auto inside = [&path](const std::string& word) { return path.empty() ? word : path + "." + word; };
  const Children of_a = children_of(a), of_b = children_of(b);
  for (const auto& [word, value] : of_a) {
    const Json* other = find(of_b, word);
    if (other != nullptr) compare(*value, *other, inside(word), found);
    if (other == nullptr) found.push_back({inside(word), text_of(*value), "nothing"});
  }
  for (const auto& [word, value] : of_b) {
    if (find(of_a, word) == nullptr) found.push_back({inside(word), "nothing", text_of(*value)});
  }
}

}  // namespace

std::vector<JsonDifference> differing_values(const std::string& a, const std::string& b) {
  std::vector<JsonDifference> found;
  const Json first = json_if_valid<Json>(a), second = json_if_valid<Json>(b);
  if (!first.is_discarded() && !second.is_discarded()) {
    compare(first, second, "", found);
  } else if (a != b) {
    found.push_back({"the whole text", a, b});
  }
  return found;
}

std::vector<std::string> json_differences(const std::string& a, const std::string& b, std::size_t most) {
  std::vector<std::string> told;
  for (const JsonDifference& difference : differing_values(a, b)) {
    if (told.size() == most) break;
    told.push_back(fmt::format("{}: {} and {}", difference.path, shortened(difference.a), shortened(difference.b)));
  }
  return told;
}

}  // namespace supple
