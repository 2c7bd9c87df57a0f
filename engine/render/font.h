// Names a font that letters are drawn with. Not here: how fonts are found (font_search.h) and drawn (text_bitmap.h).
#pragma once

#include <string>

namespace supple {

struct Font {
  std::string file;  // empty: there is no font, and no words are drawn
  int face = 0;      // number of the face in the file, which may hold several

  bool empty() const { return file.empty(); }
  auto operator<=>(const Font&) const = default;
};

}  // namespace supple
