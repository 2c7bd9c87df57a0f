#include "output/json_text.h"

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

template <class Json>
Json parsed_json(std::string_view text) {
  return Json::parse(text);
}
template <class Json>
Json parsed_json(std::istream& text) {
  return Json::parse(text);
}

template <class Json>
Json json_if_valid(std::string_view text) {
  return Json::parse(text, nullptr, false);
}
template <class Json>
Json json_if_valid(std::istream& text) {
  return Json::parse(text, nullptr, false);
}

template std::string json_text(const nlohmann::json&, int);
template std::string exact_json_text(const nlohmann::json&, int);
template nlohmann::json parsed_json(std::string_view);
template nlohmann::json parsed_json(std::istream&);
template nlohmann::json json_if_valid(std::string_view);
template nlohmann::json json_if_valid(std::istream&);
template std::string json_text(const nlohmann::ordered_json&, int);
template std::string exact_json_text(const nlohmann::ordered_json&, int);
template nlohmann::ordered_json parsed_json(std::string_view);
template nlohmann::ordered_json parsed_json(std::istream&);
template nlohmann::ordered_json json_if_valid(std::string_view);
template nlohmann::ordered_json json_if_valid(std::istream&);

}  // namespace supple
