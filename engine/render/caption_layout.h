// Finds places for captions: beside their bodies, and neither over each other nor over a body. Pure geometry in pixels,
// counted from the upper left corner of the picture. Not here: which place a caption would like to have, and what is
// tried where there is no room (captions.h).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "render/sticker.h"

namespace supple {

using Outline = std::vector<Eigen::Vector2d>;  // corners of a convex polygon, in order

bool overlaps(const PixelRect& rectangle, const Outline& outline);

// Tells on which side of its body a caption stands.
enum class CaptionSide { below, above };

// Describes a caption that wants a place: the middle of its edge that is next to its body, its size, and its side.
struct WantedCaption {
  Eigen::Vector2d edge;
  int width, height;
  CaptionSide side = CaptionSide::below;
};

// Tells how far from its wanted place a caption may stand: by less than its own height and half its width, so that it
// is read with its body, or anywhere on its side of the body.
enum class CaptionReach { near, anywhere };

// Describes a picture [pixels] and what captions must not cover in it.
struct CaptionRoom {
  std::vector<Outline> bodies;
  std::vector<PixelRect> taken;
  int width, height;
};

// Returns how far captions stay away from the edges of a picture [pixels].
int picture_margin(int width, int height);

// Returns a place for each caption: the first one from the wanted place away from the body, or a little to its sides,
// that overlaps no other caption, nothing that is taken, and no body. Nothing when some caption has no such place in
// the picture.
std::optional<std::vector<PixelRect>> caption_places(const std::vector<WantedCaption>& captions,
                                                     const CaptionRoom& room,
                                                     CaptionReach reach = CaptionReach::anywhere);

}  // namespace supple
