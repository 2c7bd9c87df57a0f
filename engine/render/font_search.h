// Finds installed fonts with fontconfig: by the name of a family, and for characters that the font of a text lacks. Not
// here: how letters are drawn (text_bitmap.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/font.h"

namespace supple {

// Tells whether this build can look for fonts: fontconfig and raqm were there when it was made.
bool searches_fonts();

// Returns the upright font of usual weight of a family; nothing where it is not installed.
std::optional<Font> font_of_family(const std::string& family);

// Returns the names of all families that are installed, sorted.
std::vector<std::string> font_families();

// Returns a font that has the glyph of a character, sans-serif where there is a choice; nothing where no installed font
// with outlines has it. Equal calls give equal fonts.
std::optional<Font> font_with(char32_t character);

}  // namespace supple
