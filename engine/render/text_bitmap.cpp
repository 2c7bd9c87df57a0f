#include "render/text_bitmap.h"

#include <fmt/core.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "base/error.h"
#include "render/code_points.h"
#include "render/font_search.h"

#ifdef SUPPLE_SCRIPTS
#include <raqm.h>
#endif

namespace supple {
namespace {

// Holds FreeType and the faces that draw a text; the first one is that of the text's font.
class Faces {
 public:
  explicit Faces(const Font& font) : fonts_{font} {
    if (FT_Init_FreeType(&freetype_) == 0) faces_.push_back(opened(font));
    if (!faces_.empty() && faces_.front() != nullptr) return;
    if (freetype_ != nullptr) FT_Done_FreeType(freetype_);
    throw RunError(fmt::format("{}: not a usable font", font.file));
  }
  Faces(const Faces&) = delete;
  Faces& operator=(const Faces&) = delete;
  ~Faces() { FT_Done_FreeType(freetype_); }  // with all faces

  FT_Face usual() const { return faces_.front(); }
  const std::vector<FT_Face>& all() const { return faces_; }

  // Returns the face that draws a character: the usual one, else that of the character before, else one that is looked
  // for; null where no font has it. A character that shows nothing by itself goes with the one before.
  FT_Face face_for(char32_t point, FT_Face before) {
    if (before != usual() && is_invisible(point)) return before;
    for (const FT_Face face : {usual(), before})
      if (FT_Get_Char_Index(face, point) != 0) return face;
    if (is_invisible(point)) return before;
    const std::optional<Font> font = font_with(point);
    return font ? face_of(*font) : nullptr;
  }

 private:
  FT_Face opened(const Font& font) const {
    FT_Face face = nullptr;
    return FT_New_Face(freetype_, font.file.c_str(), font.face, &face) == 0 ? face : nullptr;
  }
  FT_Face face_of(const Font& font) {
    const auto known = std::ranges::find(fonts_, font);
    if (known != fonts_.end()) return faces_[std::size_t(known - fonts_.begin())];
    const FT_Face face = opened(font);
    if (face == nullptr) return nullptr;
    fonts_.push_back(font);
    faces_.push_back(face);
    return face;
  }

  FT_Library freetype_ = nullptr;
  std::vector<Font> fonts_;
  std::vector<FT_Face> faces_;  // in the order of fonts_
};

// Holds a glyph and the pixel of its origin, counted from the left end of the line and from its base line down.
struct PlacedGlyph {
  FT_Face face;
  FT_UInt index;
  int x, y;
};

// Holds the glyphs of a line and where the next one would stand [pixels].
struct GlyphLine {
  std::vector<PlacedGlyph> glyphs;
  int end = 0;
};

GlyphLine side_by_side(FT_Face face, const std::vector<char32_t>& points) {
  GlyphLine line;
  for (const char32_t point : points) {
    const FT_UInt index = FT_Get_Char_Index(face, point);
    if (FT_Load_Glyph(face, index, FT_LOAD_DEFAULT) != 0) continue;
    line.glyphs.push_back({face, index, line.end, 0});
    line.end += static_cast<int>(face->glyph->advance.x >> 6);
  }
  return line;
}

void lay_over(const FT_Bitmap& from, int left, int top, TextBitmap& to) {
  for (int row = 0; row < int(from.rows); ++row) {
    for (int column = 0; column < int(from.width); ++column) {
      const int x = left + column, y = top + row;
      if (x < 0 || x >= to.width || y < 0 || y >= to.height) continue;
      std::uint8_t& target = to.coverage[std::size_t(y) * to.width + x];
      target = std::max(target, from.buffer[row * std::abs(from.pitch) + column]);
    }
  }
}

// Draws a line of glyphs, as high as the lines of a face are.
TextBitmap drawn(const GlyphLine& line, FT_Face usual) {
  const FT_Size_Metrics& metrics = usual->size->metrics;
  const int ascent = static_cast<int>(metrics.ascender >> 6);
  TextBitmap bitmap;
  bitmap.height = static_cast<int>((metrics.ascender - metrics.descender) >> 6) + 1;
  bitmap.width = std::max(line.end + 2, 1);
  bitmap.coverage.assign(std::size_t(bitmap.width) * bitmap.height, 0);
  for (const PlacedGlyph& one : line.glyphs) {
    if (FT_Load_Glyph(one.face, one.index, FT_LOAD_RENDER) != 0) continue;
    const FT_GlyphSlot glyph = one.face->glyph;
    lay_over(glyph->bitmap, one.x + glyph->bitmap_left, ascent + one.y - glyph->bitmap_top, bitmap);
  }
  return bitmap;
}

#ifdef SUPPLE_SCRIPTS

// Tells whether a face draws a text without help: it has all of the characters, and none has to be shaped.
bool draws_alone(FT_Face face, const std::vector<char32_t>& points) {
  return std::ranges::all_of(
      points, [face](char32_t point) { return stands_alone(point) && FT_Get_Char_Index(face, point) != 0; });
}

// Returns the face of each character; the usual one, with its box, where no font has it.
std::vector<FT_Face> faces_of(Faces& faces, const std::vector<char32_t>& points) {
  std::vector<FT_Face> chosen;
  for (const char32_t point : points) {
    const FT_Face before = chosen.empty() ? faces.usual() : chosen.back(), face = faces.face_for(point, before);
    chosen.push_back(face != nullptr ? face : faces.usual());
  }
  return chosen;
}

// Shapes a line: each part of it runs in the direction of its script, and the line as a whole in that of its first
// letter.
GlyphLine shaped(const std::vector<char32_t>& points, const std::vector<FT_Face>& faces) {
  const std::unique_ptr<raqm_t, decltype(&raqm_destroy)> raqm(raqm_create(), &raqm_destroy);
  const std::vector<std::uint32_t> text(points.begin(), points.end());
  bool ok = raqm && raqm_set_text(raqm.get(), text.data(), text.size()) &&
            raqm_set_par_direction(raqm.get(), RAQM_DIRECTION_DEFAULT) &&
            raqm_set_freetype_load_flags(raqm.get(), FT_LOAD_DEFAULT);
  for (std::size_t i = 0; i < faces.size() && ok; ++i) ok = raqm_set_freetype_face_range(raqm.get(), faces[i], i, 1);
  if (!ok || !raqm_layout(raqm.get())) throw RunError("a text cannot be shaped: not enough memory");
  std::size_t count = 0;
  const raqm_glyph_t* glyphs = raqm_get_glyphs(raqm.get(), &count);
  GlyphLine line;
  const auto to_pixels = [](long units) { return static_cast<int>((units + 32) >> 6); };
  long pen = 0;
  for (std::size_t g = 0; g < count; ++g) {
    line.glyphs.push_back(
        {glyphs[g].ftface, glyphs[g].index, to_pixels(pen + glyphs[g].x_offset), -to_pixels(glyphs[g].y_offset)});
    pen += glyphs[g].x_advance;
  }
  line.end = to_pixels(pen);
  return line;
}

// Returns the factor by which glyphs of other faces must become smaller to stay within a line of the usual face; 1
// where they do.
double share_that_fits(const GlyphLine& line, FT_Face usual) {
  constexpr double smallest = 0.6;
  const double slack = 1 + usual->size->metrics.y_ppem / 25.0;  // else lines would differ because one has a deep comma
  const double above = static_cast<double>(usual->size->metrics.ascender >> 6);
  const double below = static_cast<double>(-usual->size->metrics.descender >> 6) + 1;
  double share = 1;
  for (const PlacedGlyph& one : line.glyphs) {
    if (one.face == usual || FT_Load_Glyph(one.face, one.index, FT_LOAD_RENDER) != 0) continue;
    const FT_GlyphSlot glyph = one.face->glyph;
    const int top = glyph->bitmap_top - one.y, bottom = int(glyph->bitmap.rows) - top;
    if (top > above + slack) share = std::min(share, above / top);
    if (bottom > below + slack) share = std::min(share, below / bottom);
  }
  return std::max(share, smallest);
}

void set_size(FT_Face face, int pixels) { FT_Set_Pixel_Sizes(face, 0, FT_UInt(std::max(1, pixels))); }

// Draws a text with all fonts that it needs. Where letters of other fonts are higher than the line, they become
// smaller.
TextBitmap draw_with_help(Faces& faces, const std::vector<char32_t>& points, int pixels) {
  const std::vector<FT_Face> chosen = faces_of(faces, points);
  for (const FT_Face face : faces.all()) set_size(face, pixels);
  GlyphLine line = shaped(points, chosen);
  const double share = share_that_fits(line, faces.usual());
  if (share < 1) {
    for (const FT_Face face : faces.all())
      if (face != faces.usual()) set_size(face, static_cast<int>(std::floor(share * pixels)));
    line = shaped(points, chosen);
  }
  return drawn(line, faces.usual());
}

#endif

}  // namespace

TextBitmap draw_text(const Font& font, const std::string& text, int pixels) {
  Faces faces(font);
  if (FT_Set_Pixel_Sizes(faces.usual(), 0, pixels) != 0)
    throw RunError(fmt::format("{}: not a usable font", font.file));
  const std::vector<char32_t> points = code_points(text);
#ifdef SUPPLE_SCRIPTS
  if (!draws_alone(faces.usual(), points)) return draw_with_help(faces, points, pixels);
#endif
  return drawn(side_by_side(faces.usual(), points), faces.usual());
}

std::vector<std::string> characters_without_glyph(const Font& font, const std::string& text) {
  Faces faces(font);
  std::vector<std::string> missing;
  for (const char32_t point : code_points(text)) {
    if (point == '\n' || faces.face_for(point, faces.usual()) != nullptr) continue;
    const std::string character = in_utf8(point);
    if (std::ranges::find(missing, character) == missing.end()) missing.push_back(character);
  }
  return missing;
}

}  // namespace supple
