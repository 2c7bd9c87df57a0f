// Prepares text, and pictures given as text, for HTML and SVG.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace supple {

// Escapes & < > " ', so that the text fits elements and attributes. Control characters other than tab and line feed
// become spaces.
std::string markup_text(std::string_view text);

// Puts `prefix` before every id in the markup and before every reference to one.
std::string with_id_prefix(std::string_view markup, const std::string& prefix);

// Encodes bytes in the base64 of RFC 4648, for data: addresses and arrays in XML.
std::string base64_text(std::span<const std::uint8_t> bytes);

// Counts the code points of UTF-8 text, which are nearly its letters.
std::size_t count_code_points(std::string_view text);

}  // namespace supple
