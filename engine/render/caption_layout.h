// Finds places for captions: below their bodies, and neither over each other nor over a body. Pure geometry in pixels,
// counted from the upper left corner of the picture.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "render/sticker.h"

namespace supple {

using Outline = std::vector<Eigen::Vector2d>;  // corners of a convex polygon, in order

bool overlaps(const PixelRect& rectangle, const Outline& outline);

// Describes a caption that wants a place: the middle of its upper edge, and its size.
struct WantedCaption {
  Eigen::Vector2d top;
  int width, height;
};

// Returns a place for each caption: the first one below the wanted place, or a little to its sides, that overlaps no
// other caption, nothing that is taken, and no body. Nothing when some caption has no such place in the picture.
std::optional<std::vector<PixelRect>> caption_places(const std::vector<WantedCaption>& captions,
                                                     const std::vector<Outline>& bodies,
                                                     const std::vector<PixelRect>& taken, int width, int height);

}  // namespace supple
