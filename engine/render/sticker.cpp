#include "render/sticker.h"

#include <algorithm>
#include <cmath>

#include "render/caption.h"

namespace supple {

Sticker::Sticker(int width, int height)
    : width_(std::max(width, 0)), height_(std::max(height, 0)), pixels_(4 * std::size_t(width_) * height_, 0.0f) {}

// Porter and Duff's "over" (1984), with colours that are multiplied by their coverage.
void Sticker::cover(int x, int y, const Vec3& color, double opacity) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_ || opacity <= 0) return;
  float* pixel = &pixels_[4 * (std::size_t(y) * width_ + x)];
  const auto alpha = static_cast<float>(opacity);
  for (int k = 0; k < 3; ++k) pixel[k] = alpha * static_cast<float>(color[k]) + (1 - alpha) * pixel[k];
  pixel[3] = alpha + (1 - alpha) * pixel[3];
}

void Sticker::fill(const PixelRect& area, const Vec3& color, double opacity) {
  for (int y = area.y; y < area.bottom(); ++y) {
    for (int x = area.x; x < area.right(); ++x) cover(x, y, color, opacity);
  }
}

void Sticker::plate(const PixelRect& area, double radius, const Vec3& color, double opacity) {
  const auto beyond = [radius](int at, int from, int length) {  // how far a pixel's middle lies beyond the straight part
    const double middle = at + 0.5 - from;
    return std::max({0.0, radius - middle, middle - (length - radius)});
  };
  for (int y = area.y; y < area.bottom(); ++y) {
    for (int x = area.x; x < area.right(); ++x) {
      const double off = std::hypot(beyond(x, area.x, area.width), beyond(y, area.y, area.height));
      cover(x, y, color, opacity * std::clamp(radius - off + 0.5, 0.0, 1.0));
    }
  }
}

void Sticker::text(const std::string& font, const std::string& text, int pixels, int x, int y, const Vec3& color) {
  const CaptionBitmap bitmap = draw_caption(font, text, pixels);
  for (int row = 0; row < bitmap.height; ++row) {
    for (int column = 0; column < bitmap.width; ++column)
      cover(x + column, y + row, color, bitmap.coverage[std::size_t(row) * bitmap.width + column] / 255.0);
  }
}

void Sticker::onto(Image& image, int x, int y) const {
  for (int row = std::max(0, -y); row < std::min(height_, image.height - y); ++row) {
    for (int column = std::max(0, -x); column < std::min(width_, image.width - x); ++column) {
      const float* from = &pixels_[4 * (std::size_t(row) * width_ + column)];
      if (from[3] <= 0) continue;
      std::uint8_t* to = &image.rgb[3 * (std::size_t(y + row) * image.width + (x + column))];
      for (int k = 0; k < 3; ++k)
        to[k] = static_cast<std::uint8_t>(std::lround(255 * from[k] + (1 - from[3]) * to[k]));
    }
  }
}

}  // namespace supple
