#include "render/caption.h"

#include <fmt/core.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>

#include "base/error.h"
#include "base/text.h"

namespace supple {
namespace {

// Splits UTF-8 into code points; broken bytes become U+FFFD.
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

struct Library {
  FT_Library freetype = nullptr;
  FT_Face face = nullptr;

  explicit Library(const std::string& font_file) {
    if (FT_Init_FreeType(&freetype) != 0 || FT_New_Face(freetype, font_file.c_str(), 0, &face) != 0) {
      if (freetype != nullptr) FT_Done_FreeType(freetype);
      throw RunError(fmt::format("{}: not a usable font", font_file));
    }
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() {
    FT_Done_Face(face);
    FT_Done_FreeType(freetype);
  }
};

}  // namespace

CaptionBitmap draw_caption(const std::string& font_file, const std::string& text, int pixels) {
  const Library ft(font_file);
  if (FT_Set_Pixel_Sizes(ft.face, 0, pixels) != 0) throw RunError(fmt::format("{}: not a usable font", font_file));
  const auto points = code_points(text);
  CaptionBitmap bitmap;
  const int ascent = static_cast<int>(ft.face->size->metrics.ascender >> 6);
  bitmap.height = static_cast<int>((ft.face->size->metrics.ascender - ft.face->size->metrics.descender) >> 6) + 1;
  for (const bool drawing : {false, true}) {
    if (drawing) bitmap.coverage.assign(std::size_t(bitmap.width) * bitmap.height, 0);
    int pen = 0;
    for (const char32_t point : points) {
      if (FT_Load_Char(ft.face, point, drawing ? FT_LOAD_RENDER : FT_LOAD_DEFAULT) != 0) continue;
      const FT_GlyphSlot glyph = ft.face->glyph;
      if (drawing) {
        for (unsigned row = 0; row < glyph->bitmap.rows; ++row) {
          for (unsigned column = 0; column < glyph->bitmap.width; ++column) {
            const int x = pen + glyph->bitmap_left + int(column), y = ascent - glyph->bitmap_top + int(row);
            if (x < 0 || x >= bitmap.width || y < 0 || y >= bitmap.height) continue;
            std::uint8_t& target = bitmap.coverage[std::size_t(y) * bitmap.width + x];
            target = std::max(target, glyph->bitmap.buffer[row * std::abs(glyph->bitmap.pitch) + column]);
          }
        }
      }
      pen += static_cast<int>(glyph->advance.x >> 6);
    }
    bitmap.width = std::max(pen + 2, 1);
  }
  return bitmap;
}

std::vector<std::string> characters_without_glyph(const std::string& font_file, const std::string& text) {
  const Library ft(font_file);
  std::vector<std::string> missing;
  for (std::size_t at = 0, length = 0; at < text.size(); at += length) {
    length = std::max<std::size_t>(1, first_character(std::string_view(text).substr(at)));
    const std::string character = text.substr(at, length);
    if (FT_Get_Char_Index(ft.face, code_points(character).front()) == 0 &&
        std::find(missing.begin(), missing.end(), character) == missing.end())
      missing.push_back(character);
  }
  return missing;
}

}  // namespace supple
