// Words as grey bitmaps, by FreeType.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace supple {

struct CaptionBitmap {
  int width = 0, height = 0;
  std::vector<std::uint8_t> coverage;  // rows from the top, 0 to 255
};

// Throws RunError when the font cannot be used. text is UTF-8; pixels: the em's height.
CaptionBitmap draw_caption(const std::string& font_file, const std::string& text, int pixels);

}  // namespace supple
