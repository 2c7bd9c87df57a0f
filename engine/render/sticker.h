// Draws a small picture with coverage (text, plates, bars) and lays it over a finished picture, without OpenGL. Not
// here: what is written and where (captions.h, subtitles.h, legend.h, graphs.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/draw_list.h"
#include "render/font.h"

namespace supple {

// Describes a rectangle in pixels, counted from the upper left corner of a picture.
struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;
  int right() const { return x + width; }
  int bottom() const { return y + height; }
  bool overlaps(const PixelRect& other) const {
    return x < other.right() && other.x < right() && y < other.bottom() && other.y < bottom();
  }
};

// Returns the height from which the sizes of letters and graphs follow [pixels]. A picture that is taller than wide has
// those of a square one, because its width is the room that bodies and words share.
inline int height_for_letters(int width, int height) { return width < height ? width : height; }

// Colours of what is written on a picture, and of the plates behind it; sRGB.
inline const Vec3 ink(0.16, 0.16, 0.17), paper(0.97, 0.97, 0.96);

class Sticker {
 public:
  Sticker() = default;
  Sticker(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }

  // Each of these functions lays something over what is there. color: sRGB; opacity: 0 to 1.
  void fill(const PixelRect& area, const Vec3& color, double opacity = 1);
  // Fills with rounded corners of this radius [pixels].
  void plate(const PixelRect& area, double radius, const Vec3& color, double opacity);
  // Writes text whose box has its upper left corner at (x, y). pixels: the height of the font's em.
  void text(const Font& font, const std::string& text, int pixels, int x, int y, const Vec3& color);

  // Does the same with a halo around the letters, so that they can be read on any background: a light one around dark
  // letters, a dark one around light letters. The halo reaches halo(pixels) beyond the box.
  void text_with_halo(const Font& font, const std::string& text, int pixels, int x, int y, const Vec3& color);
  static int halo(int pixels) { return pixels / 8 > 1 ? pixels / 8 : 1; }

  // Lays itself over a picture; what lies outside the picture is left out.
  void onto(Image& image, int x, int y) const;

 private:
  void cover(int x, int y, const Vec3& color, double opacity);

  int width_ = 0, height_ = 0;
  std::vector<float> pixels_;  // rows from the top; sRGB times coverage, and coverage, each 0 to 1
};

}  // namespace supple
