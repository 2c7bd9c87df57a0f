#include "output/files/json_text.h"

#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

namespace supple {

template <class Json>
std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

template <class Json>
std::string exact_json_text(const Json& json, int indent) {
  return json.dump(indent);
}

namespace {

// Texts with more levels are not read, because the library writes values by recursion. What this program writes has as
// many levels as a scene, which are fewer.
constexpr int most_levels = 2000;

// Tells whether lists and objects of the text are nested by more than most_levels. Text that is not JSON may be judged
// wrongly.
bool is_too_deep(std::string_view text) {
  int levels = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\') ++i;
    if (c == '"') in_string = !in_string;
    if (in_string) continue;
    if ((c == '[' || c == '{') && ++levels > most_levels) return true;
    if (c == ']' || c == '}') --levels;
  }
  return false;
}

}  // namespace

template <class Json>
Json parsed_json(std::string_view text) {
  // The parser refuses an empty text with the exception that callers expect.
  return Json::parse(is_too_deep(text) ? std::string_view() : text);
}

template <class Json>
Json json_if_valid(std::string_view text) {
  return is_too_deep(text) ? Json(Json::value_t::discarded) : Json::parse(text, nullptr, false);
}

template <class Json>
Json json_object_in(const std::filesystem::path& file) {
  std::ifstream text(file);
  auto json = json_if_valid<Json>(std::string{std::istreambuf_iterator<char>(text), {}});
  return json.is_object() ? std::move(json) : Json(nullptr);
}

template std::string json_text(const nlohmann::json&, int);
template std::string exact_json_text(const nlohmann::json&, int);
template nlohmann::json parsed_json(std::string_view);
template nlohmann::json json_if_valid(std::string_view);
template nlohmann::json json_object_in(const std::filesystem::path&);
template std::string json_text(const nlohmann::ordered_json&, int);
template std::string exact_json_text(const nlohmann::ordered_json&, int);
template nlohmann::ordered_json parsed_json(std::string_view);
template nlohmann::ordered_json json_if_valid(std::string_view);
template nlohmann::ordered_json json_object_in(const std::filesystem::path&);

double rounded_ms(double ms) { return std::round(ms * 1e4) / 1e4; }

}  // namespace supple
