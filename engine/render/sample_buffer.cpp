#include "render/sample_buffer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace supple {
namespace {

struct Place {
  int x, y;  // in sixteenths of a pixel
};

const Place* standard_places(int samples) {
  static constexpr Place one[] = {{8, 8}}, two[] = {{12, 12}, {4, 4}}, four[] = {{6, 2}, {14, 6}, {2, 10}, {10, 14}},
                         eight[] = {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}};
  return samples == 1 ? one : samples == 2 ? two : samples == 4 ? four : eight;
}

using Floats = float __attribute__((vector_size(32)));
using Words = std::int32_t __attribute__((vector_size(32)));
template <class Integer>
struct RegisterOf;
template <>
struct RegisterOf<std::int32_t> {
  using Type = Words;
};
template <>
struct RegisterOf<std::int64_t> {
  using Type = std::int64_t __attribute__((vector_size(64)));
};

// Describes an edge of a triangle by a linear function of x and y that is negative outside. Coordinates are in parts of
// a pixel.
template <class Integer>
struct Edge {
  Integer by_x, by_y, value;  // changes of the function with x and y; its value at a place that the caller names

  // A sample on an edge belongs to the triangle on one side of it: of the two directions of an edge, one is moved by
  // the least step outwards.
  Edge(const ScreenCorner& a, const ScreenCorner& b, Integer x, Integer y)
      : by_x(Integer(a.y) - b.y), by_y(Integer(b.x) - a.x) {
    const bool owns = by_x > 0 || (by_x == 0 && by_y > 0);
    value = by_y * (y - a.y) + by_x * (x - a.x) - (owns ? 0 : 1);
  }

  // Narrows a range of pixels of a row to those in which the function may reach zero. value: the function's value at
  // the lower left of the pixel `left`. A pixel more on each side makes up for rounding.
  void narrow(int left, int& from, int& to) const {
    constexpr int parts = SampleBuffer::parts;
    if (by_x == 0) return;
    const double most = double(value) + parts * (std::max<double>(0, double(by_x)) + std::max<double>(0, double(by_y)));
    const double pixels = std::clamp(-most / (parts * double(by_x)), -1e6, 1e6);
    if (by_x > 0) from = std::max(from, left + static_cast<int>(std::floor(pixels)) - 1);
    if (by_x < 0) to = std::min(to, left + static_cast<int>(std::ceil(pixels)) + 1);
  }
};

}  // namespace

SampleBuffer::SampleBuffer(int width, int height, int samples)
    : width_(width), height_(height), samples_(samples), stride_(std::size_t(width) + lanes) {
  place_lanes();
  numbers_.resize(stride_ * height * samples);
  nearness_.resize(numbers_.size());
}

// Computes what depends on the places of the samples.
void SampleBuffer::place_lanes() {
  const Place* place = standard_places(samples_);
  for (int lane = 0; lane < lanes; ++lane) {
    const Place& at = place[lane % samples_];
    lane_x_[std::size_t(lane)] = lane / samples_ * parts + (at.x * parts / 16 + moved_x_) % parts;
    lane_y_[std::size_t(lane)] = (at.y * parts / 16 + moved_y_) % parts;
    allowed_[0][std::size_t(lane)] = -1;
    allowed_[1][std::size_t(lane)] = lane % samples_ % 2 == 0 ? -1 : 0;
  }
}

void SampleBuffer::move_samples(double x, double y) {
  moved_x_ = static_cast<int>(x * parts);
  moved_y_ = static_cast<int>(y * parts);
  place_lanes();
}

std::vector<float> SampleBuffer::places() const {
  std::vector<float> result;
  for (std::size_t s = 0; s < std::size_t(samples_); ++s)
    result.insert(result.end(), {float(lane_x_[s]) / parts, float(lane_y_[s]) / parts});
  return result;
}

void SampleBuffer::clear(int y, int from, int to) {
  const std::size_t count = std::size_t(to - from) * samples_;
  std::fill_n(numbers_.data() + at(from, y), count, 0u);
  std::fill_n(nearness_.data() + at(from, y), count, 0.0f);
}

SampleBuffer::Box SampleBuffer::fill(const std::array<ScreenCorner, 3>& corners, std::uint32_t number, Facing facing,
                                     Samples which) {
  return fill_as<false>(corners, facing, {number, which, 1});
}

SampleBuffer::Box SampleBuffer::fill_lifted(const std::array<ScreenCorner, 3>& corners, std::uint32_t number,
                                            float factor) {
  return fill_as<true>(corners, Facing::both, {number, Samples::all, factor});
}

template <bool lifted>
SampleBuffer::Box SampleBuffer::fill_as(const std::array<ScreenCorner, 3>& given, Facing facing,
                                        const Written& written) {
  constexpr Box nothing = {0, -1, 0, -1};
  std::array<ScreenCorner, 3> v = given;
  std::int64_t area =
      std::int64_t(v[1].x - v[0].x) * (v[2].y - v[0].y) - std::int64_t(v[2].x - v[0].x) * (v[1].y - v[0].y);
  if (area == 0 || (area < 0 && facing == Facing::towards)) return nothing;
  if (area < 0) {
    std::swap(v[1], v[2]);
    area = -area;
  }
  const auto [left, right] = std::minmax({v[0].x, v[1].x, v[2].x});
  const auto [low, high] = std::minmax({v[0].y, v[1].y, v[2].y});
  static_assert(parts == 1 << 8);
  const Box box = {std::max(0, left >> 8), std::min(width_ - 1, right >> 8), std::max(0, low >> 8),
                   std::min(height_ - 1, high >> 8)};
  if (box.left > box.right || box.low > box.high) return nothing;
  // The functions of the edges of a triangle of 80 pixels are below 2 * (80 * 256)^2 < 2^30, and a register that
  // reaches eight pixels beyond it adds a tenth.
  constexpr int small = 80 * parts;
  if (right - left < small && high - low < small) {
    cover<std::int32_t, lifted>(v, box, double(area), written);
  } else {
    cover<std::int64_t, lifted>(v, box, double(area), written);
  }
  return box;
}

// Writes a triangle into the samples of a box. The edges' functions and the nearness, which is linear on the screen,
// are computed for eight samples at once (Pineda 1988, "A parallel algorithm for polygon rasterization").
template <class Integer, bool lifted>
void SampleBuffer::cover(const std::array<ScreenCorner, 3>& v, const Box& box, double area, const Written& written) {
  using Register = typename RegisterOf<Integer>::Type;
  constexpr int wide = 16;  // pixels
  const Integer x = Integer(box.left) * parts, y = Integer(box.low) * parts;
  std::array<Edge<Integer>, 3> edges = {Edge<Integer>(v[0], v[1], x, y), {v[1], v[2], x, y}, {v[2], v[0], x, y}};
  const double b = double(v[1].nearness) - v[0].nearness, c = double(v[2].nearness) - v[0].nearness;
  const double near_x = (b * (double(v[2].y) - v[0].y) - c * (double(v[1].y) - v[0].y)) / area;
  const double near_y = (c * (double(v[1].x) - v[0].x) - b * (double(v[2].x) - v[0].x)) / area;
  double near_row = v[0].nearness + near_x * (double(x) - v[0].x) + near_y * (double(y) - v[0].y);
  const auto [furthest_corner, nearest_corner] = std::minmax({v[0].nearness, v[1].nearness, v[2].nearness});
  const Floats least = Floats{} + furthest_corner, most = Floats{} + nearest_corner;
  const Words own_number = Words{} + static_cast<std::int32_t>(written.number);
  Words to_x, to_y, allowed;
  std::memcpy(&to_x, lane_x_.data(), sizeof to_x);
  std::memcpy(&to_y, lane_y_.data(), sizeof to_y);
  std::memcpy(&allowed, allowed_[written.which == Samples::all ? 0 : 1].data(), sizeof allowed);
  const Register edge_x = __builtin_convertvector(to_x, Register), edge_y = __builtin_convertvector(to_y, Register);
  std::array<Register, 3> lane_edge;
  for (std::size_t k = 0; k < 3; ++k) lane_edge[k] = edges[k].by_x * edge_x + edges[k].by_y * edge_y;
  const Floats lane_near = static_cast<float>(near_x) * __builtin_convertvector(to_x, Floats) +
                           static_cast<float>(near_y) * __builtin_convertvector(to_y, Floats);
  const int step = lanes / samples_;  // pixels of a register
  const auto near_step = static_cast<float>(near_x * step * parts);
  for (int row = box.low; row <= box.high; ++row) {
    int from = box.left, to = box.right;
    if (to - from >= wide) {
      for (const Edge<Integer>& edge : edges) edge.narrow(box.left, from, to);
    }
    std::array<Register, 3> e;
    for (std::size_t k = 0; k < 3; ++k)
      e[k] = lane_edge[k] + (edges[k].value + edges[k].by_x * Integer(from - box.left) * parts);
    Floats near = lane_near + static_cast<float>(near_row + near_x * (from - box.left) * parts);
    std::uint32_t* numbers = &numbers_[at(from, row)];
    float* nearness = &nearness_[at(from, row)];
    for (int pixel = from; pixel <= to; pixel += step, numbers += lanes, nearness += lanes) {
      Floats near_before;
      Words number_before;
      std::memcpy(&near_before, nearness, sizeof near_before);
      std::memcpy(&number_before, numbers, sizeof number_before);
      Floats here = near < least ? least : near;
      here = here > most ? most : here;
      Words inside = __builtin_convertvector((e[0] | e[1] | e[2]) >= 0, Words) & allowed;
      if constexpr (lifted) {
        inside &= near_before < 0 ? here > -near_before : written.factor * here > near_before;
        here = -here;
      } else {
        inside &= here > near_before;
      }
      here = inside ? here : near_before;
      number_before = inside ? own_number : number_before;
      std::memcpy(nearness, &here, sizeof here);
      std::memcpy(numbers, &number_before, sizeof number_before);
      for (std::size_t k = 0; k < 3; ++k) e[k] += edges[k].by_x * Integer(step * parts);
      near += near_step;
    }
    for (Edge<Integer>& edge : edges) edge.value += edge.by_y * parts;
    near_row += near_y * parts;
  }
}

}  // namespace supple
