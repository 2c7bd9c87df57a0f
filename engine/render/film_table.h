// Tabulates film_of(), for code that shades many places.
#pragma once

#include <array>
#include <cstddef>

#include "render/color.h"

namespace supple {

class FilmTable {
 public:
  FilmTable() {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const double root = static_cast<double>(i) / by_root;
      values_[i] = static_cast<float>(film_of(root * root, 1));
    }
  }

  // Returns the colours of the screen, from 0 to 1, for light times the exposure; within 1e-5 of film_of(). What is not
  // a number is black.
  template <class Lanes>
  Lanes operator()(const Lanes& light) const {
    // Over the root of the light, the curve is nearly straight where it is dark.
    const Lanes place = (light.max(0.0f).sqrt() * by_root).min(static_cast<float>(intervals) - 0.001f);
    Lanes result;
    for (Eigen::Index k = 0; k < result.size(); ++k) {
      const float at = place[k] > 0 ? place[k] : 0;
      const auto i = static_cast<int>(at);
      const float low = values_[std::size_t(i)], high = values_[std::size_t(i) + 1];
      result[k] = low + (at - static_cast<float>(i)) * (high - low);
    }
    return result;
  }

 private:
  static constexpr int intervals = 2048;
  static constexpr float brightest = 3.5f;  // root of a light that is shown as white
  static constexpr float by_root = intervals / brightest;
  std::array<float, intervals + 1> values_;
};

}  // namespace supple
