#include "output/video/film_coverage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"

namespace supple {
namespace {

// Holds mean colours of blocks of pixels, with weights: a level of a pyramid.
struct Level {
  int width, height;
  std::vector<std::array<float, 4>> sums;  // red, green and blue times the weight, and the weight

  Level(int wide, int high) : width(wide), height(high), sums(std::size_t(wide) * high) {}
  std::array<float, 4>& at(int x, int y) { return sums[std::size_t(y) * width + x]; }
};

// Returns the level above, whose cells are the sums of blocks of 2 x 2. Weights are held to that of a pixel that is
// fully covered, so that near colours count more than far ones.
Level coarser(Level& fine) {
  Level level((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) {
      for (std::size_t k = 0; k < 4; ++k) level.at(x / 2, y / 2)[k] += fine.at(x, y)[k];
    }
  }
  for (std::array<float, 4>& sum : level.sums) {
    const float scale = 1 / std::max(1.0F, sum[3] / 255);
    for (float& part : sum) part *= scale;
  }
  return level;
}

}  // namespace

// Uses push and pull (Gortler et al. 1996, "The lumigraph", section 3.4), with blocks in place of smooth filters; the
// difference is not seen.
std::vector<std::uint8_t> filled_colors(int width, int height, std::span<const std::uint8_t> rgb,
                                        std::span<const std::uint8_t> alpha) {
  SUPPLE_CHECK(rgb.size(), ==, 3 * alpha.size());
  std::vector<Level> levels = {Level(width, height)};
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const float weight = alpha[i];
    levels[0].sums[i] = {weight * rgb[3 * i], weight * rgb[3 * i + 1], weight * rgb[3 * i + 2], weight};
  }
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(coarser(levels.back()));
  for (std::size_t l = levels.size() - 1; l-- > 0;) {
    for (int y = 0; y < levels[l].height; ++y) {
      for (int x = 0; x < levels[l].width; ++x) {
        if (levels[l].at(x, y)[3] <= 0) levels[l].at(x, y) = levels[l + 1].at(x / 2, y / 2);
      }
    }
  }
  std::vector<std::uint8_t> filled(rgb.begin(), rgb.end());
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const std::array<float, 4>& sum = levels[0].sums[i];
    for (std::size_t k = 0; k < 3 && alpha[i] == 0 && sum[3] > 0; ++k)
      filled[3 * i + k] = static_cast<std::uint8_t>(std::lround(sum[k] / sum[3]));
  }
  return filled;
}

std::vector<std::uint8_t> dithered_coverage(int width, std::span<const std::uint8_t> rgb,
                                            std::span<const std::uint8_t> alpha) {
  static constexpr int order[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
  std::vector<std::uint8_t> rgba;
  rgba.reserve(4 * alpha.size());
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const bool black = rgb[3 * i] + rgb[3 * i + 1] + rgb[3 * i + 2] == 0;
    const int threshold = black ? 16 * order[i / std::size_t(width) % 4][i % std::size_t(width) % 4] + 8 : 128;
    const bool covered = alpha[i] >= threshold;
    rgba.insert(rgba.end(), {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2], std::uint8_t(covered ? 255 : 0)});
  }
  return rgba;
}

}  // namespace supple
