// Converts JSON to text and back. The library's parser and writer are compiled only here: every unit that called them
// would have to compile them again, which takes seconds. Json is nlohmann::json or nlohmann::ordered_json.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace supple {

// Writes the text on one line, or with this indent. Strings need not be UTF-8; invalid bytes are replaced.
template <class Json>
std::string json_text(const Json& json, int indent = -1);
// Does the same for text that must not change unnoticed: throws nlohmann::json::type_error when a string is not UTF-8.
template <class Json>
std::string exact_json_text(const Json& json, int indent = -1);

// Rounds to tenths of microseconds, which is what times in files have.
double rounded_ms(double ms);

// Throws nlohmann::json::parse_error where the text is not JSON, or has more than 2000 levels.
template <class Json>
Json parsed_json(std::string_view text);
// Returns a discarded value where the text is not JSON, or has more than 2000 levels.
template <class Json>
Json json_if_valid(std::string_view text);
// Returns the object that a file holds; null where the file is missing or holds anything else.
template <class Json>
Json json_object_in(const std::filesystem::path& file);

}  // namespace supple
