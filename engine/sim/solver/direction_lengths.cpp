#include "sim/solver/direction_lengths.h"

#include <algorithm>
#include <cmath>

#include "sim/model/motion_error.h"

namespace supple {

void DirectionLengths::begin(const Model& model) {
  lengths_.resize(model.parts.size());
  count_ = 0;
}

// A direction that is refused until less than a hundredth of it is left tells of the contacts in its way, and not of
// how far the minimum is.
void DirectionLengths::add(const Model& model, const Positions& d, double accepted) {
  constexpr double least_share = 0.01;
  const double share = std::min(1.0, accepted / least_share);
  for (std::size_t p = 0; p < lengths_.size(); ++p) {
    std::array<double, most>& lengths = lengths_[p];
    std::shift_right(lengths.begin(), lengths.end(), 1);
    lengths[0] = share * mass_length(model, model.parts[p], d);
  }
  count_ = std::min(count_ + 1, most);
}

// The rate is the slope of a straight line through the logarithms of the lengths, by least squares. Directions that
// shrink by less than the slowest rate do not tell how many more of them there are.
double DirectionLengths::left(std::size_t part) const {
  constexpr double slowest = 0.9;
  if (count_ < 2) return 0;
  const double middle = 0.5 * (count_ - 1);
  double mean = 0, slope = 0, spread = 0;
  for (int i = 0; i < count_; ++i) {
    if (!(lengths_[part][i] > 0)) return 0;
    const double logarithm = std::log(lengths_[part][i]), later = middle - i;
    mean += logarithm / count_;
    slope += later * logarithm;
    spread += later * later;
  }
  slope /= spread;
  const double newest = std::exp(mean + slope * middle), rate = std::min(slowest, std::exp(slope));
  return newest * rate / (1 - rate);
}

}  // namespace supple
