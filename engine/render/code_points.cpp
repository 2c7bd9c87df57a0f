#include "render/code_points.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace supple {
namespace {

struct Span {
  char32_t first, last;
};

template <std::size_t N>
bool in_any(char32_t point, const std::array<Span, N>& spans) {
  return std::ranges::any_of(spans, [point](const Span& span) { return point >= span.first && point <= span.last; });
}

}  // namespace

std::vector<char32_t> code_points(const std::string& text) {
  std::vector<char32_t> points;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const int length = lead < 0x80 ? 1 : lead >> 5 == 6 ? 2 : lead >> 4 == 14 ? 3 : lead >> 3 == 30 ? 4 : 0;
    if (length == 0 || i + length > text.size()) {
      points.push_back(0xFFFD);
      ++i;
      continue;
    }
    char32_t point = length == 1 ? lead : lead & (0xFF >> (length + 1));
    for (int k = 1; k < length; ++k) point = point << 6 | (static_cast<unsigned char>(text[i + k]) & 0x3F);
    points.push_back(point);
    i += length;
  }
  return points;
}

std::string in_utf8(char32_t point) {
  const auto tail = [point](int shift) { return static_cast<char>(0x80 | ((point >> shift) & 0x3F)); };
  if (point < 0x80) return {static_cast<char>(point)};
  if (point < 0x800) return {static_cast<char>(0xC0 | point >> 6), tail(0)};
  if (point < 0x10000) return {static_cast<char>(0xE0 | point >> 12), tail(6), tail(0)};
  return {static_cast<char>(0xF0 | point >> 18), tail(12), tail(6), tail(0)};
}

// These are the blocks of Unicode whose characters are all drawn side by side; the marks in them that combine with the
// letter before are left out.
bool stands_alone(char32_t point) {
  constexpr std::array<Span, 12> plain = {{
      {0x0000, 0x02FF},  // Latin, phonetic signs
      {0x0370, 0x0482},  // Greek, Cyrillic
      {0x048A, 0x058F},  // Cyrillic, Armenian
      {0x1E00, 0x1FFF},  // more Latin and Greek
      {0x2010, 0x2027},  // punctuation
      {0x202F, 0x205E},
      {0x2070, 0x20CF},  // raised figures, currencies
      {0x2100, 0x2BFF},  // letters as symbols, arrows, mathematics, boxes, dingbats
      {0x2E80, 0x3029},  // radicals and punctuation of Chinese, Japanese and Korean
      {0x3030, 0x3098},  // hiragana
      {0x309B, 0xA4CF},  // katakana, ideographs, Yi
      {0xAC00, 0xD7A3},  // Korean syllables
  }};
  constexpr std::array<Span, 2> more = {{{0xF900, 0xFAFF}, {0xFF00, 0xFFFD}}};  // ideographs; wide and narrow forms
  return in_any(point, plain) || in_any(point, more);
}

bool is_invisible(char32_t point) {
  constexpr std::array<Span, 7> spans = {{{0x00AD, 0x00AD},
                                          {0x200B, 0x200F},
                                          {0x202A, 0x202E},
                                          {0x2060, 0x206F},
                                          {0xFE00, 0xFE0F},
                                          {0xFEFF, 0xFEFF},
                                          {0xE0100, 0xE01EF}}};
  return in_any(point, spans);
}

bool is_ideographic(char32_t point) {
  constexpr std::array<Span, 4> spans = {{{0x2E80, 0xA4CF}, {0xF900, 0xFAFF}, {0xFF01, 0xFF60}, {0x20000, 0x3FFFF}}};
  return in_any(point, spans);
}

bool closes(char32_t point) {
  constexpr std::u32string_view signs =
      U"、。，．・：；？！’”）］｝〕〉》」』】〙〗ーぁぃぅぇぉっゃゅょゎァィゥェォッャュョヮ々";
  return signs.find(point) != signs.npos;
}

}  // namespace supple
