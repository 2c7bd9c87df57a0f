#include "render/caption_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace supple {
namespace {

PixelRect widened(const PixelRect& r, int by) { return {r.x - by, r.y - by, r.width + 2 * by, r.height + 2 * by}; }

bool is_free(const PixelRect& place, const std::vector<PixelRect>& taken, const std::vector<Outline>& bodies) {
  const PixelRect with_air = widened(place, std::max(2, place.height / 6));
  return std::ranges::none_of(taken, [&](const PixelRect& one) { return one.overlaps(with_air); }) &&
         std::ranges::none_of(bodies, [&](const Outline& body) { return overlaps(place, body); });
}

// Returns the first free place for a caption, row after row away from its body, in the middle of a row before its
// sides.
std::optional<PixelRect> place_of(const WantedCaption& caption, const CaptionRoom& room,
                                  const std::vector<PixelRect>& taken, CaptionReach reach) {
  constexpr double near_side = 0.5, near_rows = 0.7;  // over the caption's width and height
  const int margin = picture_margin(room.width, room.height);
  const double left = caption.edge.x() - 0.5 * caption.width;
  const bool above = caption.side == CaptionSide::above;
  const int first = static_cast<int>(std::lround(caption.edge.y())) - (above ? caption.height : 0);
  const int row = std::max(1, caption.height / 3);
  PixelRect place{0, first, caption.width, caption.height};
  for (; above ? place.y >= margin : place.bottom() <= room.height - margin; place.y += above ? -row : row) {
    if (reach == CaptionReach::near && std::abs(place.y - first) > near_rows * caption.height) break;
    for (const double aside : {0.0, -0.25, 0.25, -0.5, 0.5, -0.75, 0.75}) {
      if (reach == CaptionReach::near && std::abs(aside) > near_side) break;
      place.x = static_cast<int>(std::lround(left + aside * caption.width));
      place.x = std::clamp(place.x, margin, std::max(margin, room.width - margin - caption.width));
      if (place.right() <= room.width && is_free(place, taken, room.bodies)) return place;
    }
  }
  return std::nullopt;
}

}  // namespace

int picture_margin(int width, int height) { return std::max(2, height_for_letters(width, height) / 100); }

// Applies the separating axis theorem: the axes are those of the rectangle and the normals of the outline's edges.
bool overlaps(const PixelRect& rectangle, const Outline& outline) {
  if (outline.empty()) return false;
  const std::array<Eigen::Vector2d, 4> corners = {
      Eigen::Vector2d(rectangle.x, rectangle.y), Eigen::Vector2d(rectangle.right(), rectangle.y),
      Eigen::Vector2d(rectangle.right(), rectangle.bottom()), Eigen::Vector2d(rectangle.x, rectangle.bottom())};
  const auto apart_along = [&](const Eigen::Vector2d& axis) {
    double least[2] = {1e300, 1e300}, most[2] = {-1e300, -1e300};
    const auto include = [&](int which, const Eigen::Vector2d& point) {
      least[which] = std::min(least[which], axis.dot(point));
      most[which] = std::max(most[which], axis.dot(point));
    };
    for (const Eigen::Vector2d& corner : corners) include(0, corner);
    for (const Eigen::Vector2d& corner : outline) include(1, corner);
    return most[0] <= least[1] || most[1] <= least[0];
  };
  if (apart_along(Eigen::Vector2d::UnitX()) || apart_along(Eigen::Vector2d::UnitY())) return false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    if (apart_along({-edge.y(), edge.x()})) return false;
  }
  return true;
}

std::optional<std::vector<PixelRect>> caption_places(const std::vector<WantedCaption>& captions,
                                                     const CaptionRoom& room, CaptionReach reach) {
  std::vector<std::size_t> order(captions.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return captions[a].edge.x() < captions[b].edge.x(); });
  std::vector<PixelRect> places(captions.size()), all = room.taken;
  for (const std::size_t i : order) {
    const std::optional<PixelRect> place = place_of(captions[i], room, all, reach);
    if (!place) return std::nullopt;
    places[i] = *place;
    all.push_back(*place);
  }
  return places;
}

}  // namespace supple
