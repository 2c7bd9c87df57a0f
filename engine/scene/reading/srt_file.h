// Reads subtitles from a file of the SubRip format (.srt): blocks of a number, two times and lines of text, separated
// by blank lines. Not here: subtitles that a scene's own file lists (look_reader.cpp).
#pragma once

#include <string_view>
#include <vector>

#include "scene/definition/text_def.h"

namespace supple {

// Tells what keeps a line from being drawn as it stands: bytes that are not UTF-8, a control character, or a mark of
// style. Empty where nothing does.
std::string subtitle_fault(std::string_view line);

// Returns the subtitles of a file. text: its content, in UTF-8; name: its name, for messages. Throws InputError with
// the first line that is wrong.
std::vector<Subtitle> read_srt(std::string_view text, const std::string& name);

}  // namespace supple
