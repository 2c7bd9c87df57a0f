// Defines what pictures say in words, as a scene describes it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/files/source_file.h"

namespace supple {

// Holds a line of text that pictures show from one time of the film to another. The picture of a frame shows it when
// the frame's time t has from < t <= to: a player that shows the frames one after the other shows it from `from` to
// `to`.
struct Subtitle {
  double from = 0, to = 0;  // [s]
  std::string text;         // in UTF-8; a newline begins another line
  FilePlace place;          // in the scene or in its file of subtitles
};

// Chooses what pictures say in words; each part can be switched.
struct TextDef {
  std::string font;  // family of the letters; empty: the usual one
  FilePlace font_place;
  // The title and the time stand in the upper left corner.
  bool title = false, time = false;
  // These numbers stand below the caption of each body, and tell of its steps in the frame.
  bool method = false, milliseconds = false, iterations = false, error = false;
  bool notes() const { return method || milliseconds || iterations || error; }
  // These are small graphs over the film so far, in a corner.
  bool error_graph = false, time_graph = false;
  // These stand at the lower edge, in the order in which they begin.
  std::vector<Subtitle> subtitles;
  std::optional<SourceFile> subtitle_file;  // the file from which some of them were read; nothing: none were
};

}  // namespace supple
