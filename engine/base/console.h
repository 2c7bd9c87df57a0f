// Writes text to the standard streams. A closed or full one must not end a run: text that cannot be written is dropped.
// Colour appears on terminals alone, and only on the word with which an error or a warning begins.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace supple {

// Writes the text, highlighted if the stream is a terminal that may be coloured.
void say(std::FILE* stream, std::string_view text);

// Marks "supple:" (bold red) and "warning:" (bold) wherever a line begins with them.
std::string highlighted(std::string_view text);

// Tells whether to colour: on a terminal whose TERM is set and not "dumb", unless NO_COLOR is set and not empty
// (https://no-color.org). The last two arguments are the environment's values; null means that the variable is not set.
bool may_colour(bool terminal, const char* no_color, const char* term);

}  // namespace supple
