#include "render/exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "render/color.h"
#include "render/view.h"

namespace supple {
namespace {

// The multiples of these two numbers fill a square evenly (the generalised golden ratio, Roberts 2018).
constexpr double stride_x = 0.7548776662466927, stride_y = 0.5698402909980532;

double fraction(double value) { return value - std::floor(value); }

// Returns a stride that visits all of `count` places in an order which has nothing in common with their own.
int scattering_stride(int count) {
  int stride = std::max(1, static_cast<int>(std::lround(count * (std::numbers::phi - 1))));
  while (std::gcd(stride, count) != 1) ++stride;
  return stride;
}

// Returns a place on a disc of radius one: places of Vogel's spiral have the same area each.
Eigen::Vector2d on_spiral(int place, int count) {
  const double radius = std::sqrt((place + 0.5) / count);
  const double angle = place * 2 * std::numbers::pi * (2 - std::numbers::phi);
  return radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

}  // namespace

std::vector<ExposureSample> exposure_samples(const Exposure& exposure, int count) {
  std::vector<ExposureSample> samples;
  const int stride = scattering_stride(count);
  for (int i = 0; i < count; ++i) {
    const double until_now = 1 - (i + 0.5) / count;
    const auto place = static_cast<int>(static_cast<long long>(i) * stride % count);
    samples.push_back({1 - exposure.open * until_now,
                       on_spiral(place, count),
                       {fraction(0.5 + i * stride_x), fraction(0.5 + i * stride_y)}});
  }
  return samples;
}

Camera camera_of(const DrawList& list, const ExposureSample& sample) {
  const Exposure& exposure = *list.exposure;
  Camera camera = list.camera;
  if (exposure.open > 0) {
    const Camera& before = exposure.camera_before;
    const double back = 1 - sample.time;
    camera.eye += back * (before.eye - camera.eye);
    camera.target += back * (before.target - camera.target);
    camera.fov_deg += back * (before.fov_deg - camera.fov_deg);
  }
  if (exposure.aperture > 0) {
    const Eigen::Matrix4d to_eye = look_at(camera.eye, camera.target).cast<double>();
    const Eigen::Vector2d place = 0.5 * exposure.aperture * sample.on_lens;
    const Vec3 moved = to_eye.block<2, 3>(0, 0).transpose() * place;
    camera.eye += moved;
    camera.target += moved;
    camera.shift = place / exposure.focus;
  }
  return camera;
}

void positions_of(const DrawList& list, const ExposureSample& sample, std::vector<std::vector<float>>& positions) {
  const std::vector<std::vector<float>>&before = list.exposure->before, &now = list.positions;
  const auto back = static_cast<float>(1 - sample.time);
  positions.resize(now.size());
  for (std::size_t m = 0; m < now.size(); ++m) {
    positions[m] = now[m];
    if (m >= before.size() || before[m].size() != now[m].size()) continue;
    for (std::size_t i = 0; i < now[m].size(); ++i) positions[m][i] += back * (before[m][i] - now[m][i]);
  }
}

namespace {

// Neighbouring copies of what moves, and of what is out of focus, lie this far from each other at most [pixels], as
// long as `most_pictures` are enough for it. With fewer pictures a bright edge becomes a staircase.
constexpr double between_times = 1, between_places = 1.5;
constexpr int fewest_pictures = 16, most_pictures = 128;

// Measures how far an exposure spreads points of the picture.
class Spread {
 public:
  Spread(const Stage& stage, const DrawList& list) : stage_(stage), list_(list) {
    const Camera& before = list.exposure->open > 0 ? list.exposure->camera_before : list.camera;
    frames_[0] = of_camera(list.camera);
    frames_[1] = of_camera(before);
  }

  // Returns the number of pictures that a mesh needs. A share of its points may be spread further, so that a few that
  // come close to the eye do not decide.
  double needed(std::size_t mesh) const {
    constexpr std::size_t enough = 2000;
    constexpr double decides = 0.98;
    const std::vector<std::vector<float>>& earlier = list_.exposure->before;
    const std::vector<float>& now = list_.positions[mesh];
    const bool moves = list_.exposure->open > 0 && mesh < earlier.size() && earlier[mesh].size() == now.size();
    const std::vector<float>& before = moves ? earlier[mesh] : now;
    const std::size_t step = 3 * std::max<std::size_t>(1, now.size() / 3 / enough);
    std::vector<double> found;
    for (std::size_t i = 0; i + 2 < now.size(); i += step) {
      const double one = of_point(Vec3(now[i], now[i + 1], now[i + 2]), Vec3(before[i], before[i + 1], before[i + 2]));
      if (one >= 0) found.push_back(one);
    }
    if (found.empty()) return 0;
    const auto nth = found.begin() + static_cast<std::ptrdiff_t>(decides * static_cast<double>(found.size() - 1));
    std::ranges::nth_element(found, nth);
    return *nth;
  }

 private:
  struct Eye {
    Eigen::Matrix4d world;
    double focal;  // [pixels]
  };

  Eye of_camera(const Camera& camera) const {
    return {look_at(camera.eye, camera.target).cast<double>(),
            0.5 * stage_.height / std::tan(camera.fov_deg * std::numbers::pi / 360)};
  }

  // Returns the number of pictures that a point needs; negative where it is in no picture.
  double of_point(const Vec3& now, const Vec3& before) const {
    const Exposure& exposure = *list_.exposure;
    const std::array<Vec3, 2> at = {(frames_[0].world * now.homogeneous()).head<3>(),
                                    (frames_[1].world * before.homogeneous()).head<3>()};
    std::array<Eigen::Vector2d, 2> pixel;
    bool in_picture = false;
    for (std::size_t k = 0; k < 2; ++k) {
      const double depth = -at[k].z();
      if (depth <= 1e-9) return -1;
      pixel[k] = frames_[k].focal / depth * at[k].head<2>();
      in_picture =
          in_picture || (2 * std::abs(pixel[k].x()) <= stage_.width && 2 * std::abs(pixel[k].y()) <= stage_.height);
    }
    if (!in_picture) return -1;
    const double moved = exposure.open * (pixel[0] - pixel[1]).norm();
    const double disc = exposure.aperture * frames_[0].focal * std::abs(1 / exposure.focus + 1 / at[0].z());
    const double across = disc / between_places;
    return std::max(moved / between_times, std::numbers::pi / 4 * across * across);
  }

  const Stage& stage_;
  const DrawList& list_;
  std::array<Eye, 2> frames_;  // this frame's camera, and that of the frame before
};

}  // namespace

int pictures_needed(const Stage& stage, const DrawList& list) {
  if (list.exposure->samples > 0) return list.exposure->samples;
  const Spread spread(stage, list);
  double needed = fewest_pictures;
  for (std::size_t m = 0; m < list.positions.size(); ++m) needed = std::max(needed, spread.needed(m));
  return static_cast<int>(std::min<double>(most_pictures, std::ceil(needed)));
}

namespace {

constexpr int light_steps = 1 << 16;  // steps of linear light; a level of sRGB is at least 19 of them wide

}  // namespace

LightSum::LightSum() {
  for (int level = 0; level < 256; ++level) linear_.push_back(static_cast<float>(linear_of(level / 255.0)));
  levels_.resize(light_steps + 1);
  int level = 0;
  for (int step = 0; step <= light_steps; ++step) {
    while (level < 255 && linear_of((level + 0.5) / 255) <= double(step) / light_steps) ++level;
    levels_[std::size_t(step)] = static_cast<std::uint8_t>(level);
  }
}

void LightSum::add(const Image& image) {
  width_ = image.width;
  height_ = image.height;
  ++pictures_;
  light_.resize(image.rgb.size());
  coverage_.resize(image.alpha.size());
  if (image.alpha.empty()) {
    for (std::size_t i = 0; i < image.rgb.size(); ++i) light_[i] += linear_[image.rgb[i]];
    return;
  }
  for (std::size_t i = 0; i < image.alpha.size(); ++i) {
    const float share = static_cast<float>(image.alpha[i]) / 255;
    coverage_[i] += share;
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) light_[k] += share * linear_[image.rgb[k]];
  }
}

Image LightSum::mean() const {
  Image image{width_, height_, std::vector<std::uint8_t>(light_.size())};
  const auto level = [this](float light) {
    return levels_[std::size_t(std::clamp(light, 0.0F, 1.0F) * float(light_steps) + 0.5F)];
  };
  const float share = 1 / static_cast<float>(pictures_);
  if (coverage_.empty()) {
    for (std::size_t i = 0; i < light_.size(); ++i) image.rgb[i] = level(share * light_[i]);
    return image;
  }
  image.alpha.resize(coverage_.size());
  for (std::size_t i = 0; i < coverage_.size(); ++i) {
    image.alpha[i] = static_cast<std::uint8_t>(255 * share * coverage_[i] + 0.5F);
    if (image.alpha[i] == 0) continue;
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) image.rgb[k] = level(light_[k] / coverage_[i]);
  }
  return image;
}

}  // namespace supple
