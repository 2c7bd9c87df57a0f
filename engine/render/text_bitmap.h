// Draws any text as grey bitmaps, with FreeType: captions, notes, subtitles, legends and graphs alike. Characters that
// the font lacks are drawn by another installed font that has them (font_search.h), and scripts whose letters join,
// stack or run from right to left are shaped (raqm, which is HarfBuzz and FriBidi). Not here: where words stand
// (captions.h, subtitles.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/font.h"

namespace supple {

// Holds a line of text as pixels, of a caption or of any other words.
struct TextBitmap {
  int width = 0, height = 0;
  std::vector<std::uint8_t> coverage;  // rows from the top, 0 to 255
};

// Draws a text in UTF-8 on one line, which is as high as the font's, whichever other fonts help it; pixels: the height
// of the font's em. A character that no font has becomes a box. Throws RunError when the font cannot be used.
TextBitmap draw_text(const Font& font, const std::string& text, int pixels);

// Returns the characters of a text in UTF-8 for which neither the font nor another one that can be found has a glyph,
// so that boxes are drawn; each once, in the order of the text. Throws RunError when the font cannot be used.
std::vector<std::string> characters_without_glyph(const Font& font, const std::string& text);

}  // namespace supple
