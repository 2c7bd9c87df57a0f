#include "film/pictures/contact_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "render/text_bitmap.h"

namespace supple {
namespace {

using Color = std::array<std::uint8_t, 3>;
constexpr Color sheet_paper = {255, 255, 255}, sheet_ink = {29, 31, 33}, sheet_soft = {122, 128, 134},
                sheet_field = {238, 239, 241};

constexpr int border = 40, cell_gap = 22, title_pixels = 34, word_pixels = 19;
constexpr int widest_sheet = 1900, widest_picture = 460, narrowest_picture = 180;

struct Size {
  int width = 0, height = 0;
};

// Shrinks an image: every pixel of the result is the average of the pixels that it covers.
PngImage shrunk(const PngImage& image, Size size) {
  PngImage small{size.width, size.height, std::vector<std::uint8_t>(std::size_t(size.width) * size.height * 3)};
  const double sx = double(image.width) / size.width, sy = double(image.height) / size.height;
  for (int y = 0; y < size.height; ++y) {
    const int top = int(y * sy), bottom = std::min(image.height, std::max(top + 1, int(std::ceil((y + 1) * sy))));
    for (int x = 0; x < size.width; ++x) {
      const int left = int(x * sx), right = std::min(image.width, std::max(left + 1, int(std::ceil((x + 1) * sx))));
      std::array<double, 3> sum = {};
      double weight = 0;
      for (int v = top; v < bottom; ++v) {
        const double share_v = std::min<double>(v + 1, (y + 1) * sy) - std::max<double>(v, y * sy);
        for (int u = left; u < right; ++u) {
          const double share = share_v * (std::min<double>(u + 1, (x + 1) * sx) - std::max<double>(u, x * sx));
          const std::uint8_t* pixel = &image.rgb[(std::size_t(v) * image.width + u) * 3];
          for (std::size_t c = 0; c < 3; ++c) sum[c] += share * pixel[c];
          weight += share;
        }
      }
      for (std::size_t c = 0; c < 3; ++c)
        small.rgb[(std::size_t(y) * size.width + x) * 3 + c] = static_cast<std::uint8_t>(std::lround(sum[c] / weight));
    }
  }
  return small;
}

class Canvas {
 public:
  explicit Canvas(Size size) {
    image_ = {size.width, size.height, std::vector<std::uint8_t>(std::size_t(size.width) * size.height * 3)};
    fill(0, 0, size, sheet_paper);
  }

  void fill(int left, int top, Size size, const Color& color) {
    for (int y = top; y < top + size.height; ++y)
      for (int x = left; x < left + size.width; ++x) blend(x, y, color, 255);
  }

  void place(int left, int top, const PngImage& picture) {
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const std::uint8_t* pixel = &picture.rgb[(std::size_t(y) * picture.width + x) * 3];
        blend(left + x, top + y, {pixel[0], pixel[1], pixel[2]}, 255);
      }
    }
  }

  void write(int left, int top, const TextBitmap& words, const Color& color) {
    for (int y = 0; y < words.height; ++y)
      for (int x = 0; x < words.width; ++x)
        blend(left + x, top + y, color, words.coverage[std::size_t(y) * words.width + x]);
  }

  PngImage take() { return std::move(image_); }

 private:
  void blend(int x, int y, const Color& color, int coverage) {
    if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
    std::uint8_t* pixel = &image_.rgb[(std::size_t(y) * image_.width + x) * 3];
    for (std::size_t c = 0; c < 3; ++c)
      pixel[c] = static_cast<std::uint8_t>((pixel[c] * (255 - coverage) + color[c] * coverage + 127) / 255);
  }

  PngImage image_;
};

TextBitmap bitmap_of(const Sheet& sheet, const std::string& words, int pixels) {
  return sheet.font.empty() || words.empty() ? TextBitmap{} : draw_text(sheet.font, words, pixels);
}

// Draws as many of the words as fit, and "…" in the place of the rest.
TextBitmap fitted(const Sheet& sheet, const std::string& words, int pixels, int width) {
  TextBitmap bitmap = bitmap_of(sheet, words, pixels);
  for (std::string rest = words; bitmap.width > width && !rest.empty();) {
    rest.pop_back();
    while (!rest.empty() && (static_cast<unsigned char>(rest.back()) & 0xC0) == 0x80) rest.pop_back();  // inside a sign
    bitmap = bitmap_of(sheet, rest + "\xE2\x80\xA6", pixels);
  }
  return bitmap;
}

// Draws "name = value", or the value alone where both do not fit.
TextBitmap fitted_value(const Sheet& sheet, const std::string& words, int width) {
  const std::size_t equals = words.find(" = ");
  const bool fits = equals == std::string::npos || bitmap_of(sheet, words, word_pixels).width <= width;
  return fitted(sheet, fits ? words : words.substr(equals + 3), word_pixels, width);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",  ") + word;
  return text;
}

// Returns the lines of all captions: one line each where that fits for all, otherwise a line for each word.
std::vector<std::vector<std::string>> caption_lines(const Sheet& sheet, int width) {
  std::vector<std::vector<std::string>> lines;
  bool one_line = true;
  for (const SheetPicture& picture : sheet.pictures) {
    const int mark = bitmap_of(sheet, picture.mark, word_pixels).width;
    one_line &= bitmap_of(sheet, joined(picture.words), word_pixels).width + mark + 10 <= width;
  }
  for (const SheetPicture& picture : sheet.pictures)
    lines.push_back(one_line ? std::vector<std::string>{joined(picture.words)} : picture.words);
  return lines;
}

// Returns the size that all pictures are fitted into: the first picture's shape, no wider than the sheet has room for.
Size picture_size(const Sheet& sheet, const std::vector<std::optional<PngImage>>& images) {
  const int room = std::clamp(widest_sheet / sheet.columns, narrowest_picture, widest_picture);
  for (const auto& image : images) {
    if (!image) continue;
    const int width = std::min(image->width, room);
    return {width, std::max(1, int(std::lround(double(image->height) * width / image->width)))};
  }
  return {room, room * 9 / 16};
}

Size fitting(const PngImage& image, Size cell) {
  const double scale = std::min({1.0, double(cell.width) / image.width, double(cell.height) / image.height});
  return {std::max(1, int(std::lround(image.width * scale))), std::max(1, int(std::lround(image.height * scale)))};
}

std::vector<std::optional<PngImage>> read_pictures(const Sheet& sheet) {
  std::vector<std::optional<PngImage>> images;
  for (const SheetPicture& picture : sheet.pictures) {
    images.emplace_back();
    if (!picture.file.empty()) images.back() = read_png(picture.file);
  }
  return images;
}

}  // namespace

PngImage compose(const Sheet& sheet) {
  const auto images = read_pictures(sheet);
  const Size cell = picture_size(sheet, images);
  const auto lines = caption_lines(sheet, cell.width);
  std::size_t most_lines = 0;
  for (const auto& caption : lines) most_lines = std::max(most_lines, caption.size());
  const int line = sheet.font.empty() ? 0 : word_pixels * 13 / 10;
  const int row_height = cell.height + 8 + line * int(most_lines) + cell_gap;
  const int rows = (int(sheet.pictures.size()) + sheet.columns - 1) / sheet.columns;
  const int width = 2 * border + sheet.columns * (cell.width + cell_gap) - cell_gap;
  const TextBitmap title = fitted(sheet, sheet.title, title_pixels, width - 2 * border);
  const int top = border + (title.height > 0 ? title.height + cell_gap : 0);
  Canvas canvas({width, top + rows * row_height - cell_gap + border});
  canvas.write(border, border - 4, title, sheet_ink);
  for (std::size_t i = 0; i < sheet.pictures.size(); ++i) {
    const int x = border + int(i) % sheet.columns * (cell.width + cell_gap),
              y = top + int(i) / sheet.columns * row_height;
    if (images[i]) {
      const PngImage small = shrunk(*images[i], fitting(*images[i], cell));
      canvas.place(x + (cell.width - small.width) / 2, y + (cell.height - small.height) / 2, small);
    } else {
      canvas.fill(x, y, cell, sheet_field);
      const TextBitmap words = fitted(sheet, sheet.pictures[i].missing, word_pixels, cell.width);
      canvas.write(x + (cell.width - words.width) / 2, y + (cell.height - words.height) / 2, words, sheet_soft);
    }
    const TextBitmap mark = bitmap_of(sheet, sheet.pictures[i].mark, word_pixels);
    canvas.write(x + cell.width - mark.width, y + cell.height + 8, mark, sheet_soft);
    for (std::size_t k = 0; k < lines[i].size(); ++k) {
      const int room = cell.width - (k == 0 && mark.width > 0 ? mark.width + 10 : 0);
      canvas.write(x, y + cell.height + 8 + line * int(k), fitted_value(sheet, lines[i][k], room), sheet_ink);
    }
  }
  return canvas.take();
}

}  // namespace supple
