// Lays subtitles over pictures: lines in the middle of the lower edge, within the part of the picture that every screen
// shows, wrapped to its width, and on a dark plate, so that they are read on any background. Not here: which subtitle a
// picture shows (film/pictures/picture_words.h).
#pragma once

#include <string>
#include <vector>

#include "render/sticker.h"

namespace supple {

// Breaks a text into lines that are at most so wide [pixels], in letters of this em, at spaces and beside ideographs.
// It has as few lines as can be, about equally long. A word that is wider than a line is broken where it must be.
std::vector<std::string> wrapped(const Font& font, const std::string& text, int em, int width);

class Subtitles {
 public:
  // All of the stage's subtitles have one size of letters; it becomes smaller where one of them would fill more than a
  // third of the picture's height.
  explicit Subtitles(const Stage& stage);

  // Returns the room that the film's subtitles take, whichever one stands there; without size where there are none.
  const PixelRect& room() const { return room_; }

  // Takes the subtitle of the next picture, which may be empty, and returns its place; without size where there is
  // none.
  PixelRect show(const std::string& text);

  // Lays the subtitle of show() over the picture.
  void draw(Image& image) const;

 private:
  Sticker sticker_of(const std::string& text) const;

  Font font_;
  int width_, height_;     // of the picture [pixels]
  int em_ = 0, line_ = 0;  // height of the letters, and of a line [pixels]
  PixelRect room_;
  std::string shown_;  // the text of `sticker_`
  Sticker sticker_;
};

}  // namespace supple
