// Draws any text as grey bitmaps, with FreeType: captions, notes, legends and graphs alike. Not here: where captions
// stand (captions.h, caption_layout.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace supple {

struct CaptionBitmap {
  int width = 0, height = 0;
  std::vector<std::uint8_t> coverage;  // rows from the top, 0 to 255
};

// Draws a text in UTF-8; pixels: the height of the font's em. Throws RunError when the font cannot be used.
CaptionBitmap draw_caption(const std::string& font_file, const std::string& text, int pixels);

// Returns the characters of a text in UTF-8 for which the font has no glyph, so that boxes are drawn; each once, in the
// order of the text. Throws RunError when the font cannot be used.
std::vector<std::string> characters_without_glyph(const std::string& font_file, const std::string& text);

}  // namespace supple
