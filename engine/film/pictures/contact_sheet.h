// Composes many small pictures on one sheet, with a caption below each.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/files/png_file.h"
#include "render/font.h"

namespace supple {

struct SheetPicture {
  std::filesystem::path file;           // a PNG; empty: a grey field that says `missing`
  std::string missing = {};             // such as "failed"
  std::vector<std::string> words = {};  // of the caption, "name = value", joined where they fit on one line
  std::string mark = {};                // in grey, at the right of the caption's first line
};

struct Sheet {
  std::string title;
  std::vector<SheetPicture> pictures;  // row by row
  int columns = 1;
  Font font;  // empty: no words
};

// Composes the sheet. Pictures keep their shape and are made smaller, never larger. Throws InputError where a picture
// cannot be read.
PngImage compose(const Sheet& sheet);

}  // namespace supple
