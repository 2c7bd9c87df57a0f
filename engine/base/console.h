// Words for the terminal. A closed or full standard stream must not end a run: what cannot be said is left unsaid.
// Colour is for terminals alone: the words that a line of trouble begins with, nothing else.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace supple {

// Writes the text; on a terminal that may be coloured, highlighted.
void say(std::FILE* stream, std::string_view text);

// "supple:" (bold red) and "warning:" (bold) marked where a line begins with them.
std::string highlighted(std::string_view text);

// Whether to colour: a terminal, no NO_COLOR (https://no-color.org: set and not empty), and TERM other than "dumb".
// The last two as in the environment; null: not set.
bool may_colour(bool terminal, const char* no_color, const char* term);

}  // namespace supple
