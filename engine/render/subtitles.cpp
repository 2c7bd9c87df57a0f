#include "render/subtitles.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "render/code_points.h"
#include "render/text_bitmap.h"

namespace supple {
namespace {

// The part of a picture in which words are sure to be seen leaves a twentieth free at each edge (EBU R 95).
constexpr double free_edge = 0.05;
constexpr double longest_line = 26;  // over the em: about 50 letters, which are read at a glance
constexpr double most_of_height = 1.0 / 3;

// Letters on this plate can be read even where the picture is white: their contrast to the plate is above 7 to 1 there.
const Vec3 plate_color(0.05, 0.05, 0.06), letter_color(0.98, 0.98, 0.97);
constexpr double plate_opacity = 0.72;

int margin_of(int height) { return std::max(2, static_cast<int>(std::lround(free_edge * height))); }

int line_width(int width, int em) {
  const double safe = (1 - 2 * free_edge) * width - em;  // with the plate's own edges
  return std::max(1, static_cast<int>(std::min(safe, longest_line * em)));
}

// Holds a piece of text that is not broken, whether a space follows it, and its width without that space [pixels].
struct Piece {
  std::string text;
  bool space_after = false;
  double width = 0;
};

// Takes a paragraph apart where lines may be broken.
std::vector<Piece> pieces_of(const std::string& paragraph) {
  std::vector<Piece> pieces(1);
  bool after_ideograph = false;
  for (const char32_t point : code_points(paragraph)) {
    const bool ideograph = is_ideographic(point);
    if (point == ' ') {
      if (!pieces.back().text.empty()) {
        pieces.back().space_after = true;
        pieces.emplace_back();
      }
    } else {
      if ((ideograph || after_ideograph) && !closes(point) && !pieces.back().text.empty()) pieces.emplace_back();
      pieces.back().text += in_utf8(point);
    }
    after_ideograph = ideograph;
  }
  if (pieces.back().text.empty()) pieces.pop_back();
  return pieces;
}

// Breaks pieces that are wider than a line.
std::vector<Piece> narrowed(const Font& font, const std::vector<Piece>& pieces, int em, int width) {
  std::vector<Piece> result;
  for (const Piece& piece : pieces) {
    Piece part;
    for (const char32_t point : code_points(piece.text)) {
      const std::string longer = part.text + in_utf8(point);
      if (!part.text.empty() && draw_text(font, longer, em).width > width) {
        result.push_back(part);
        part.text.clear();
      }
      part.text += in_utf8(point);
    }
    part.space_after = piece.space_after;
    result.push_back(part);
  }
  return result;
}

// Fills line after line. width: the most of a line [pixels]; space: the width of a space.
std::vector<std::string> filled(const std::vector<Piece>& pieces, double width, double space) {
  std::vector<std::string> lines;
  double reach = 0;
  bool gap = false;
  for (const Piece& piece : pieces) {
    const double next = reach + (gap ? space : 0) + piece.width;
    if (lines.empty() || next > width) {
      lines.push_back(piece.text);
      reach = piece.width;
    } else {
      lines.back() += (gap ? " " : "") + piece.text;
      reach = next;
    }
    gap = piece.space_after;
  }
  return lines;
}

std::vector<std::string> wrapped_paragraph(const Font& font, const std::string& text, int em, int width) {
  // A bitmap is wider than its letters by a pixel at either side.
  const auto reach = [&](const std::string& words) { return draw_text(font, words, em).width - 2.0; };
  if (reach(text) <= width) return {text};
  std::vector<Piece> pieces = pieces_of(text);
  const bool too_wide = std::ranges::any_of(pieces, [&](const Piece& one) { return reach(one.text) > width; });
  if (too_wide) pieces = narrowed(font, pieces, em, width);
  for (Piece& piece : pieces) piece.width = reach(piece.text);
  const double space = reach(" ");
  // The narrowest lines that are no more in number are about equally long.
  const std::size_t fewest = filled(pieces, width, space).size();
  double low = 0, high = width;
  while (high - low > 0.25 * em) {
    const double middle = 0.5 * (low + high);
    (filled(pieces, middle, space).size() <= fewest ? high : low) = middle;
  }
  return filled(pieces, high, space);
}

}  // namespace

std::vector<std::string> wrapped(const Font& font, const std::string& text, int em, int width) {
  std::vector<std::string> lines;
  std::istringstream paragraphs(text);
  for (std::string paragraph; std::getline(paragraphs, paragraph);)
    for (std::string& line : wrapped_paragraph(font, paragraph, em, width)) lines.push_back(std::move(line));
  return lines;
}

Subtitles::Subtitles(const Stage& stage) : font_(stage.font), width_(stage.width), height_(stage.height) {
  if (font_.empty() || stage.subtitles.empty()) return;
  const int height = height_for_letters(width_, height_);
  const int largest = std::max(10, static_cast<int>(std::lround(height / 22.0))), smallest = std::max(8, largest / 2);
  PixelRect block;
  for (em_ = largest;; --em_) {
    line_ = draw_text(font_, "X", em_).height;
    block = {};
    for (const std::string& text : stage.subtitles) {
      const Sticker one = sticker_of(text);
      block.width = std::max(block.width, one.width());
      block.height = std::max(block.height, one.height());
    }
    if (block.height <= most_of_height * height_ || em_ <= smallest) break;
  }
  room_ = {(width_ - block.width) / 2, height_ - margin_of(height_) - block.height, block.width, block.height};
}

Sticker Subtitles::sticker_of(const std::string& text) const {
  const std::vector<std::string> lines = wrapped(font_, text, em_, line_width(width_, em_));
  std::vector<int> widths;
  for (const std::string& line : lines) widths.push_back(draw_text(font_, line, em_).width);
  const int pad = std::max(2, em_ / 2), air = std::max(1, em_ / 8);
  const int width = *std::ranges::max_element(widths) + 2 * pad, height = int(lines.size()) * line_ + 2 * air;
  Sticker sticker(width, height);
  sticker.plate({0, 0, width, height}, 0.25 * em_, plate_color, plate_opacity);
  for (std::size_t i = 0; i < lines.size(); ++i)
    sticker.text(font_, lines[i], em_, (width - widths[i]) / 2, air + int(i) * line_, letter_color);
  return sticker;
}

PixelRect Subtitles::show(const std::string& text) {
  if (em_ == 0 || text.empty()) {
    sticker_ = {};
  } else if (text != shown_) {
    sticker_ = sticker_of(text);
  }
  shown_ = text;
  return {(width_ - sticker_.width()) / 2, room_.bottom() - sticker_.height(), sticker_.width(), sticker_.height()};
}

void Subtitles::draw(Image& image) const {
  sticker_.onto(image, (width_ - sticker_.width()) / 2, room_.bottom() - sticker_.height());
}

}  // namespace supple
