#include "render/color_map.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "render/color.h"

namespace supple {
namespace {

// These are the two matrices of OKLab: from linear sRGB to cone responses, and from their cube roots to L, a and b.
const Mat3& to_cones() {
  static const Mat3 matrix = (Mat3() << 0.4122214708, 0.5363325363, 0.0514459929, 0.2119034982, 0.6806995451,
                              0.1073969566, 0.0883024619, 0.2817188376, 0.6299787005)
                                 .finished();
  return matrix;
}
const Mat3& to_lab() {
  static const Mat3 matrix = (Mat3() << 0.2104542553, 0.7936177850, -0.0040720468, 1.9779984951, -2.4285922050,
                              0.4505937099, 0.0259040371, 0.7827717662, -0.8086757660)
                                 .finished();
  return matrix;
}

double srgb_of(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

// Computes viridis (van der Walt and Smith 2015) by a polynomial of degree six in each channel (Zucker 2019,
// "Matplotlib colormaps", a least-squares fit that stays within 0.01 of the table).
Vec3 viridis(double t) {
  static const std::array<Vec3, 7> c = {Vec3(0.2777273272234177, 0.005407344544966578, 0.3340998053353061),
                                        Vec3(0.1050930431085774, 1.404613529898575, 1.384590162594685),
                                        Vec3(-0.3308618287255563, 0.214847559468213, 0.09509516302823659),
                                        Vec3(-4.634230498983486, -5.799100973351585, -19.33244095627987),
                                        Vec3(6.228269936347081, 14.17993336680509, 56.69055260068105),
                                        Vec3(4.776384997670288, -13.74514537774601, -65.35303263337234),
                                        Vec3(-5.435455855934631, 4.645852612178535, 26.3124352495832)};
  Vec3 sum = c[6];
  for (int i = 5; i >= 0; --i) sum = (sum * t + c[i]).eval();
  return sum.cwiseMax(0).cwiseMin(1);
}

// Returns the sRGB colour at the share t of a straight line in OKLab. from, to: its ends in OKLab.
Vec3 mixed(const Vec3& from, const Vec3& to, double t) { return srgb_of_oklab((1 - t) * from + t * to); }

Vec3 hue(double lightness, double chroma, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return {lightness, chroma * std::cos(angle), chroma * std::sin(angle)};
}

Vec3 color_at(ColorMap map, double t) {
  constexpr double blue = 265, yellow = 98, orange = 55;  // hue angles [degrees]
  switch (map) {
    case ColorMap::viridis: return viridis(t);
    case ColorMap::blue_yellow: return mixed(hue(0.28, 0.11, blue), hue(0.92, 0.14, yellow), t);
    case ColorMap::blue_orange: break;
  }
  const Vec3 middle = hue(0.86, 0, 0);
  return t < 0.5 ? mixed(hue(0.4, 0.16, blue), middle, 2 * t) : mixed(middle, hue(0.4, 0.11, orange), 2 * t - 1);
}

}  // namespace

Vec3 oklab_of(const Vec3& srgb) {
  const Vec3 cones = to_cones() * linear_of(srgb);
  return to_lab() * Vec3(std::cbrt(cones.x()), std::cbrt(cones.y()), std::cbrt(cones.z()));
}

Vec3 srgb_of_oklab(const Vec3& lab) {
  static const Mat3 from_lab = to_lab().inverse(), from_cones = to_cones().inverse();
  const Vec3 root = from_lab * lab;
  const Vec3 linear = from_cones * Vec3(root.array().cube());
  return {srgb_of(linear.x()), srgb_of(linear.y()), srgb_of(linear.z())};
}

std::vector<Vec3> colors_of(ColorMap map, int count) {
  std::vector<Vec3> colors;
  for (int i = 0; i < count; ++i) colors.push_back(color_at(map, static_cast<double>(i) / (count - 1)));
  return colors;
}

}  // namespace supple
