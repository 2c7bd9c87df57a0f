// Decodes names of files as models write them. A part of supple-read-surface.
#pragma once

#include <string>
#include <string_view>

namespace supple {

// Replaces %20 and the like by the bytes that they stand for.
inline std::string decoded_uri(std::string_view text) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_coded = text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0;
    result += is_coded ? char(16 * digit(text[i + 1]) + digit(text[i + 2])) : text[i];
    i += is_coded ? 2 : 0;
  }
  return result;
}

}  // namespace supple
