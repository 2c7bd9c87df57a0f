// Takes texts in UTF-8 apart into characters, and knows of each what drawing and breaking lines must know.
#pragma once

#include <string>
#include <vector>

namespace supple {

// Splits UTF-8 into code points; broken bytes become U+FFFD.
std::vector<char32_t> code_points(const std::string& text);

// Writes a code point in UTF-8.
std::string in_utf8(char32_t point);

// Tells whether a character is drawn as it stands, from left to right and beside the one before it. Others join, stack,
// change with their neighbours, or run from right to left, and need shaping.
bool stands_alone(char32_t point);

// Tells whether a character shows nothing by itself: it joins or parts others, or sets their direction.
bool is_invisible(char32_t point);

// Tells whether a line may be broken on both sides of a character without a space, as in Chinese and Japanese.
bool is_ideographic(char32_t point);
// Tells whether an ideographic character must not begin a line: closing brackets, full stops, small kana.
bool closes(char32_t point);

}  // namespace supple
