#include "geometry/skins/skin_middles.h"

#include <algorithm>

namespace supple {
namespace {

template <class Value, std::size_t size>
void append_mean(std::vector<std::array<Value, size>>& list, std::size_t a, std::size_t b) {
  if (list.empty()) return;
  std::array<Value, size> mean;
  for (std::size_t k = 0; k < size; ++k) mean[k] = (list[a][k] + list[b][k]) / 2;
  list.push_back(mean);
}

}  // namespace

SkinMiddles::SkinMiddles(Skin& skin)
    : skin_(skin), next_smooth_(skin.smooth.empty() ? 0 : 1 + *std::ranges::max_element(skin.smooth)) {}

void SkinMiddles::append(std::size_t a, std::size_t b) {
  skin_.occlusion.push_back((skin_.occlusion[a] + skin_.occlusion[b]) / 2);
  append_mean(skin_.paint, a, b);
  append_mean(skin_.square, a, b);
  append_mean(skin_.flat, a, b);
  if (!skin_.color.empty()) {
    const SurfaceColor &one = skin_.color[a], &other = skin_.color[b];
    skin_.color.push_back({(one.red + other.red) / 2, (one.green + other.green) / 2, (one.blue + other.blue) / 2,
                           one.texture, (one.u + other.u) / 2, (one.v + other.v) / 2});
  }
  if (skin_.smooth.empty()) return;
  const auto [known, added] = smooth_.try_emplace(std::minmax({skin_.smooth[a], skin_.smooth[b]}), next_smooth_);
  if (added) ++next_smooth_;
  skin_.smooth.push_back(known->second);
}

}  // namespace supple
