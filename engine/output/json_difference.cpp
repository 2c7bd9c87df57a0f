#include "output/json_difference.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

std::string shortened(const Json& value) {
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string element_name(const Json& a, std::size_t i) {
  const bool named = a[i].is_object() && a[i].contains("name") && a[i]["name"].is_string();
  return named ? a[i]["name"].get<std::string>() : fmt::format("{}", i);
}

void compare(const Json& a, const Json& b, const std::string& path, std::size_t most, std::vector<std::string>& found) {
  if (found.size() >= most || a == b) return;
  const auto inside = [&path](const std::string& name) { return path.empty() ? name : path + "." + name; };
  if (a.is_object() && b.is_object()) {
    for (const auto& [key, value] : a.items()) {
      if (b.contains(key)) compare(value, b[key], inside(key), most, found);
      if (!b.contains(key)) found.push_back(fmt::format("{}: {} and nothing", inside(key), shortened(value)));
    }
    for (const auto& [key, value] : b.items()) {
      if (!a.contains(key)) found.push_back(fmt::format("{}: nothing and {}", inside(key), shortened(value)));
    }
  } else if (a.is_array() && b.is_array() && a.size() == b.size() && !a.empty() && !a.front().is_primitive()) {
    for (std::size_t i = 0; i < a.size(); ++i) compare(a[i], b[i], inside(element_name(a, i)), most, found);
  } else {
    found.push_back(fmt::format("{}: {} and {}", path, shortened(a), shortened(b)));
  }
  if (found.size() > most) found.resize(most);
}

}  // namespace

std::vector<std::string> json_differences(const std::string& a, const std::string& b, std::size_t most) {
  std::vector<std::string> found;
  const Json first = Json::parse(a, nullptr, false), second = Json::parse(b, nullptr, false);
  if (first.is_discarded() || second.is_discarded()) {
    if (a != b) found.push_back("the whole text");
    return found;
  }
  compare(first, second, "", most, found);
  return found;
}

}  // namespace supple
