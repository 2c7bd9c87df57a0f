#include "render/sticker.h"

#include <algorithm>
#include <cmath>

#include "render/text_bitmap.h"

namespace supple {

Sticker::Sticker(int width, int height)
    : width_(std::max(width, 0)), height_(std::max(height, 0)), pixels_(4 * std::size_t(width_) * height_, 0.0f) {}

// Lays a colour over a pixel by Porter and Duff's "over" (1984), with colours that are multiplied by their coverage.
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
  const auto beyond = [radius](int at, int from,
                               int length) {  // how far a pixel's middle lies beyond the straight part
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

void Sticker::text(const Font& font, const std::string& text, int pixels, int x, int y, const Vec3& color) {
  const TextBitmap bitmap = draw_text(font, text, pixels);
  for (int row = 0; row < bitmap.height; ++row) {
    for (int column = 0; column < bitmap.width; ++column)
      cover(x + column, y + row, color, bitmap.coverage[std::size_t(row) * bitmap.width + column] / 255.0);
  }
}

void Sticker::text_with_halo(const Font& font, const std::string& text, int pixels, int x, int y, const Vec3& color) {
  const TextBitmap bitmap = draw_text(font, text, pixels);
  const Vec3 around = color.mean() < 0.5 ? Vec3(0.97, 0.97, 0.96) : Vec3(0.06, 0.06, 0.07);
  const int reach = halo(pixels);
  const auto coverage = [&bitmap](int column, int row) {
    const bool inside = column >= 0 && row >= 0 && column < bitmap.width && row < bitmap.height;
    return inside ? bitmap.coverage[std::size_t(row) * bitmap.width + column] / 255.0 : 0.0;
  };
  for (int row = -reach; row < bitmap.height + reach; ++row) {
    for (int column = -reach; column < bitmap.width + reach; ++column) {
      double nearest = 0;  // coverage of letters within reach, less with the distance
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          const double fade = std::clamp(1.3 - std::hypot(dx, dy) / (reach + 0.5), 0.0, 1.0);
          nearest = std::max(nearest, fade * coverage(column + dx, row + dy));
        }
      }
      cover(x + column, y + row, around, 0.8 * nearest);
    }
  }
  for (int row = 0; row < bitmap.height; ++row) {
    for (int column = 0; column < bitmap.width; ++column) cover(x + column, y + row, color, coverage(column, row));
  }
}

void Sticker::onto(Image& image, int x, int y) const {
  for (int row = std::max(0, -y); row < std::min(height_, image.height - y); ++row) {
    for (int column = std::max(0, -x); column < std::min(width_, image.width - x); ++column) {
      const float* from = &pixels_[4 * (std::size_t(row) * width_ + column)];
      if (from[3] <= 0) continue;
      const std::size_t pixel = std::size_t(y + row) * image.width + (x + column);
      std::uint8_t* to = &image.rgb[3 * pixel];
      const float behind = image.alpha.empty() ? 1 - from[3] : (1 - from[3]) * image.alpha[pixel] / 255;
      const float all = from[3] + behind;
      for (int k = 0; k < 3; ++k)
        to[k] = static_cast<std::uint8_t>(std::lround((255 * from[k] + behind * to[k]) / all));
      if (!image.alpha.empty()) image.alpha[pixel] = static_cast<std::uint8_t>(std::lround(255 * all));
    }
  }
}

std::vector<std::uint8_t> over(const Image& image, const Vec3& background) {
  std::vector<std::uint8_t> rgb = image.rgb;
  for (std::size_t i = 0; i < image.alpha.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double covered = image.alpha[i] / 255.0;
      rgb[3 * i + k] = static_cast<std::uint8_t>(
          std::lround(covered * rgb[3 * i + k] + (1 - covered) * 255 * background[static_cast<Eigen::Index>(k)]));
    }
  }
  return rgb;
}

}  // namespace supple
