#include "output/video/film_colors.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace supple {
namespace {

// Weights of red, green and blue in units of 2^-16.
struct Weights {
  int red, green, blue;
};

constexpr double red_share = 0.2126, blue_share = 0.0722, green_share = 1 - red_share - blue_share;

constexpr int fixed(double weight) { return static_cast<int>(weight * 65536 + (weight < 0 ? -0.5 : 0.5)); }

// scale: the factor from the steps of a byte to those of the signal.
constexpr Weights weights_of(double red, double green, double blue, double scale) {
  return {fixed(red * scale), fixed(green * scale), fixed(blue * scale)};
}

constexpr Weights luma = weights_of(red_share, green_share, blue_share, 219.0 / 255);
// The distance from the least to the largest difference between a colour and luma.
constexpr double blue_span = 2 * (1 - blue_share), red_span = 2 * (1 - red_share);
constexpr Weights blue_chroma = weights_of(-red_share, -green_share, 1 - blue_share, 224.0 / 255 / blue_span);
constexpr Weights red_chroma = weights_of(1 - red_share, -green_share, -blue_share, 224.0 / 255 / red_span);

void set_luma(const std::uint8_t* rgb, int count, std::uint8_t* out) {
  for (int x = 0; x < count; ++x) {
    const int sum = luma.red * rgb[3 * x] + luma.green * rgb[3 * x + 1] + luma.blue * rgb[3 * x + 2];
    out[x] = static_cast<std::uint8_t>((sum + (16 << 16) + (1 << 15)) >> 16);
  }
}

// Adds two rows, channel by channel, and weighs each even pixel with its neighbours: 1/4, 1/2, 1/4. The sums are eight
// times the colours. padded: scratch of 3 * (width + 1) numbers, in which the first pixel stands twice.
void sum_for_chroma(const std::uint8_t* upper, const std::uint8_t* lower, int width, std::uint16_t* padded,
                    std::uint16_t* sums) {
  for (int i = 0; i < 3 * width; ++i) padded[3 + i] = static_cast<std::uint16_t>(upper[i] + lower[i]);
  std::copy_n(padded + 3, 3, padded);
  for (int x = 0; x < width / 2; ++x) {
    for (int k = 0; k < 3; ++k) {
      const std::uint16_t* at = padded + 6 * x + k;
      sums[3 * x + k] = static_cast<std::uint16_t>(at[0] + 2 * at[3] + at[6]);
    }
  }
}

void set_chroma(const std::uint16_t* sums, int count, const Weights& weights, std::uint8_t* out) {
  for (int x = 0; x < count; ++x) {
    const int sum = weights.red * sums[3 * x] + weights.green * sums[3 * x + 1] + weights.blue * sums[3 * x + 2];
    out[x] = static_cast<std::uint8_t>((sum + (128 << 19) + (1 << 18)) >> 19);
  }
}

// The same for 10 bits.
constexpr Weights fine_luma = weights_of(red_share, green_share, blue_share, 876.0 / 255);
constexpr Weights fine_blue = weights_of(-red_share, -green_share, 1 - blue_share, 896.0 / 255 / blue_span);
constexpr Weights fine_red = weights_of(1 - red_share, -green_share, -blue_share, 896.0 / 255 / red_span);

void set_fine(std::span<const std::uint8_t> rgb, const Weights& weights, int middle, std::uint8_t* out) {
  for (std::size_t i = 0; i < rgb.size(); i += 3, out += 2) {
    const int sum = weights.red * rgb[i] + weights.green * rgb[i + 1] + weights.blue * rgb[i + 2];
    const int value = (sum + (middle << 16) + (1 << 15)) >> 16;
    out[0] = static_cast<std::uint8_t>(value & 255);
    out[1] = static_cast<std::uint8_t>(value >> 8);
  }
}

}  // namespace

void film_planes(int width, int height, std::span<const std::uint8_t> rgb, std::vector<std::uint8_t>& planes) {
  SUPPLE_CHECK(width % 2 + height % 2, ==, 0);
  SUPPLE_CHECK(rgb.size(), ==, std::size_t(width) * height * 3);
  const std::size_t pixels = std::size_t(width) * height;
  planes.resize(pixels + pixels / 2);
  std::vector<std::uint16_t> padded(3 * std::size_t(width + 1)), sums(3 * std::size_t(width / 2));
  for (int y = 0; y < height; ++y) set_luma(&rgb[3 * std::size_t(width) * y], width, &planes[std::size_t(width) * y]);
  for (int y = 0; y < height / 2; ++y) {
    const std::uint8_t* upper = &rgb[6 * std::size_t(width) * y];
    sum_for_chroma(upper, upper + 3 * std::size_t(width), width, padded.data(), sums.data());
    std::uint8_t* blue = &planes[pixels + std::size_t(width / 2) * y];
    set_chroma(sums.data(), width / 2, blue_chroma, blue);
    set_chroma(sums.data(), width / 2, red_chroma, blue + pixels / 4);
  }
}

void fine_film_planes(std::span<const std::uint8_t> rgb, std::span<const std::uint8_t> alpha,
                      std::vector<std::uint8_t>& planes) {
  const std::size_t pixels = rgb.size() / 3;
  planes.resize(2 * (3 * pixels + alpha.size()));
  set_fine(rgb, fine_luma, 64, planes.data());
  set_fine(rgb, fine_blue, 512, planes.data() + 2 * pixels);
  set_fine(rgb, fine_red, 512, planes.data() + 4 * pixels);
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const int value = (alpha[i] * 1023 + 127) / 255;
    planes[6 * pixels + 2 * i] = static_cast<std::uint8_t>(value & 255);
    planes[6 * pixels + 2 * i + 1] = static_cast<std::uint8_t>(value >> 8);
  }
}

}  // namespace supple
