#include "output/files/markup.h"

#include <algorithm>

namespace supple {

std::string markup_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      case '\'': result += "&#39;"; break;
      default: result += static_cast<unsigned char>(c) < 32 && c != '\t' && c != '\n' ? ' ' : c;
    }
  }
  return result;
}

std::string base64_text(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string with_id_prefix(std::string_view markup, const std::string& prefix) {
  constexpr std::string_view places[] = {" id=\"", " id='", "href=\"#", "href='#", "url(#"};
  std::string result;
  bool in_tag = false;
  for (std::size_t i = 0; i < markup.size();) {
    if (markup[i] == '<') in_tag = true;
    if (markup[i] == '>') in_tag = false;
    const auto* place = std::find_if(std::begin(places), std::end(places),
                                     [&](std::string_view p) { return in_tag && markup.substr(i, p.size()) == p; });
    if (place == std::end(places)) {
      result += markup[i++];
    } else {
      result += *place;
      result += prefix;
      i += place->size();
    }
  }
  return result;
}

std::size_t count_code_points(std::string_view text) {
  return std::size_t(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace supple
