#include "render/ground_shade.h"

#include <algorithm>

namespace supple {
namespace {

constexpr int lanes = GroundShade::lanes;
using Lanes = GroundShade::Lanes;

Lanes smoothstep(float low, float high, const Lanes& value) {
  const Lanes t = ((value - low) / (high - low)).max(0.0f).min(1.0f);
  return t * t * (3 - 2 * t);
}

// Returns by how much a pixel's colour is moved, less than a level, so that a smooth gradient shows no bands (Bayer
// 1973, ordered dither of 4 x 4 pixels) [levels].
float dither(int x, int y) {
  const int across = x ^ y;
  const int order = (across & 1) << 3 | (y & 1) << 2 | (across & 2) | (y & 2) >> 1;
  return (static_cast<float>(order) - 7.5f) / 16;
}

// Returns the amounts for every second pixel of a row from a pixel on [levels].
Lanes dithers(int x, int y) {
  Lanes result;
  for (int k = 0; k < lanes; ++k) result[k] = dither(x + 2 * k, y);
  return result;
}

}  // namespace

GroundShade::GroundShade(int width, int height, GroundShown shown)
    : width_(width),
      height_(height),
      light_width_((width + 1) / 2),
      light_height_((height + 1) / 2),
      shown_(shown),
      wanted_(width, height),
      stride_(std::size_t(wanted_.columns()) * lanes + 2) {
  for (int k = 0; k < planes(); ++k)
    planes_[std::size_t(k)].resize(stride_ * (std::size_t(wanted_.rows()) * lanes + 2));
}

void GroundShade::set_stage(const StageLight& light, const Vec3& stage) {
  light_ = light;
  stage_ = stage;
}

void GroundShade::shade_bare(const Tiles& tiles, std::vector<std::uint32_t>& picture) {
  shade_all(tiles, nullptr, nullptr, picture);
}

void GroundShade::shade(const Tiles& tiles, const GroundLight& lit, const GroundOcclusion& open,
                        std::vector<std::uint32_t>& picture) {
  shade_all(tiles, &lit, &open, picture);
}

void GroundShade::shade_all(const Tiles& tiles, const GroundLight* lit, const GroundOcclusion* open,
                            std::vector<std::uint32_t>& picture) {
  wanted_ = tiles;
  wanted_.widen();
  for (int row = 0; row < tiles.rows(); ++row) {
    for (int column = 0; column < tiles.columns(); ++column) {
      if (wanted_.marked(column, row)) light_tile(column, row, lit, open);
    }
  }
  for (int row = 0; row < tiles.rows(); ++row) {
    for (int column = 0; column < tiles.columns(); ++column) {
      if (tiles.marked(column, row)) write_tile(column, row, picture);
    }
  }
}

// Computes the planes in a tile.
void GroundShade::light_tile(int column, int row, const GroundLight* lit, const GroundOcclusion* open) {
  const int left = column * lanes;
  for (int y = row * lanes; y < (row + 1) * lanes; ++y) {
    Lanes reaching = Lanes::Ones();
    if (lit != nullptr) {
      const std::uint16_t* from = lit->data() + std::size_t(std::min(y, light_height_ - 1)) * light_width_;
      for (int k = 0; k < lanes; ++k)
        reaching[k] = static_cast<float>(from[std::min(left + k, light_width_ - 1)]) * (1.0f / 65535);
    }
    light_places(left, y, reaching, open);
  }
  extend_tile(column, row);
}

// Continues the planes in a tile by one place beyond the picture, where it lies at the picture's border.
void GroundShade::extend_tile(int column, int row) {
  const int left = column * lanes, right = left + lanes - 1, low = row * lanes, high = low + lanes - 1;
  const bool first = column == 0, last = column + 1 == wanted_.columns();
  const auto extend = [&](int k, int x, int y, int across, int along) {
    *plane(k, x + across, y + along) = 2 * *plane(k, x, y) - *plane(k, x - across, y - along);
  };
  for (int k = 0; k < planes(); ++k) {
    for (int y = low; y <= high; ++y) {
      if (first) extend(k, left, y, -1, 0);
      if (last) extend(k, right, y, 1, 0);
    }
    for (int x = first ? left - 1 : left; x <= (last ? right + 1 : right); ++x) {
      if (row == 0) extend(k, x, low, 0, -1);
      if (row + 1 == wanted_.rows()) extend(k, x, high, 0, 1);
    }
  }
}

// Computes the planes at places in a row. lit: shares of the key light.
void GroundShade::light_places(int left, int y, const Lanes& lit, const GroundOcclusion* open) {
  const auto ray = [&](int axis) -> Lanes {
    const auto first = static_cast<float>(light_.rays.corner[axis] + (2 * y + 1) * light_.rays.up[axis]);
    return first + 2 * static_cast<float>(light_.rays.right[axis]) *
                       (static_cast<float>(left) + Lanes::LinSpaced(0.5f, lanes - 0.5f));
  };
  const auto eye = [&](int axis) { return static_cast<float>(light_.camera.eye[axis]); };
  // Rays that do not meet the ground go to the sky, which looks like ground far away.
  constexpr float far_away = 1e9f;
  const Lanes down = -eye(1) / ray(1), way = (down > 0).select(down.min(far_away), far_away);
  const Lanes x = eye(0) + way * ray(0), z = eye(2) + way * ray(2);
  const Lanes across = x - static_cast<float>(stage_.x()), along = z - static_cast<float>(stage_.y());
  const Lanes away = (across * across + along * along).sqrt() / static_cast<float>(stage_.z());
  const Lanes fade = smoothstep(0.9f, 3.2f, away);
  Lanes sky = Lanes::Ones();
  if (open != nullptr) sky = (open->at(x, z) + GroundOcclusion::unseen).min(1.0f);
  // The ground under full light gets its own colour: light is scaled so that key and sky add up to the background's
  // white.
  const auto key_share = static_cast<float>(light_.rig.key_share), sky_share = static_cast<float>(light_.rig.sky_share);
  static constexpr float sky_tint[] = {0.97f, 1.0f, 1.04f};
  const auto shown = [&](int color, const Lanes& key, const Lanes& open_sky) -> Lanes {
    const auto ground = static_cast<float>(1.06 * light_.ground[color]);
    const auto background = static_cast<float>(light_.background[color]);
    const Lanes light = ground * (key + sky_share * sky_tint[color] * open_sky);
    return film_(Lanes(2 * static_cast<float>(light_.exposure) * (light + fade * (background - light))));
  };
  const Lanes key = key_share * (0.12f + 0.88f * lit) * (0.55f + 0.45f * sky);
  if (shown_ == GroundShown::all) {
    for (int color = 0; color < 3; ++color) Eigen::Map<Lanes>(plane(color, left, y)) = shown(color, key, sky);
    return;
  }
  // Programs lay pictures over each other in the colours of the screen, so that is where the share that is left is
  // taken.
  static constexpr float luma[] = {0.2126f, 0.7152f, 0.0722f};  // of BT.709
  const Lanes full_key = Lanes::Constant(key_share), full_sky = Lanes::Ones();
  Lanes here = Lanes::Zero(), bare = Lanes::Zero();
  for (int color = 0; color < 3; ++color) {
    here += luma[color] * shown(color, key, sky);
    bare += luma[color] * shown(color, full_key, full_sky);
  }
  Eigen::Map<Lanes>(plane(0, left, y)) = (1 - here / bare.max(1e-3f)).max(0.0f).min(1.0f);
}

// Interpolates the planes in a tile, dithers and writes them. Each pixel lies a quarter of a step from the nearest
// place of half the resolution. It takes the mean of the four interpolated values that lie half a step from it along
// both axes, which smooths what the shares of light differ in from one block of 2 x 2 places to the next.
void GroundShade::write_tile(int column, int row, std::vector<std::uint32_t>& picture) const {
  constexpr float far = 0.125f, here = 0.5f, near = 0.375f;
  constexpr float levels = 255;
  const int left = column * Tiles::edge, width = std::min(Tiles::edge, width_ - left);
  for (int y = row * Tiles::edge; y < std::min(height_, (row + 1) * Tiles::edge); ++y) {
    const int place = y / 2, nearer = y % 2 == 0 ? place - 1 : place + 1, farther = 2 * place - nearer;
    Lanes packed[2] = {Lanes::Zero(), Lanes::Zero()};  // of the pixels with even and with odd numbers
    const Lanes dithered[2] = {dithers(left, y) + 0.5f, dithers(left + 1, y) + 0.5f};
    for (int k = 0; k < planes(); ++k) {
      const auto column_at = [&](int off) -> Lanes {
        const auto values = [&](int line) { return Eigen::Map<const Lanes>(plane(k, left / 2 + off, line)); };
        return near * values(nearer) + here * values(place) + far * values(farther);
      };
      const Lanes before = column_at(-1), at = column_at(0), after = column_at(1);
      const Lanes colors[2] = {near * before + here * at + far * after, far * before + here * at + near * after};
      // Sums of three bytes are exact in single precision.
      for (int odd = 0; odd < 2; ++odd)
        packed[odd] +=
            static_cast<float>(1 << 8 * k) * (levels * colors[odd] + dithered[odd]).max(0.0f).min(levels).floor();
    }
    std::uint32_t pixels[Tiles::edge];
    for (int i = 0; i < Tiles::edge; ++i) {
      const auto bytes = static_cast<std::uint32_t>(packed[i % 2][i / 2]);
      pixels[i] = shown_ == GroundShown::all ? bytes | 0xff000000u : bytes << 24;
    }
    std::copy_n(pixels, width, picture.data() + std::size_t(y) * width_ + left);
  }
}

}  // namespace supple
