// Text, and pictures as text, inside HTML and SVG.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace supple {

// With & < > " ' escaped, fit for elements and attributes. Control characters but tab and line feed become spaces.
std::string markup_text(std::string_view text);

// The markup with `prefix` before every id and every reference to one.
std::string with_id_prefix(std::string_view markup, const std::string& prefix);

// Bytes as RFC 4648's base64, for data: addresses.
std::string base64_text(std::span<const std::uint8_t> bytes);

// Letters of UTF-8 text, or nearly: code points.
std::size_t count_signs(std::string_view text);

}  // namespace supple
