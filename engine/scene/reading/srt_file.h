// Reads subtitles from a file of the SubRip format (.srt): blocks with a number, the two times and lines of text, which
// blank lines part. Not here: subtitles that a scene's own file lists (look_reader.cpp).
#pragma once

#include <string_view>
#include <vector>

#include "scene/definition/text_def.h"

namespace supple {

// Tells what keeps a line from being drawn as it stands: a control character, or a mark of style; empty where it can
// be.
std::string subtitle_fault(std::string_view line);

// text: in UTF-8; name: of the file, for messages. Throws InputError with the first line that is wrong.
std::vector<Subtitle> read_srt(std::string_view text, const std::string& name);

}  // namespace supple
