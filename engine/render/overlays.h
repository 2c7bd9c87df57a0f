// Finds where the things stand that have one place in all pictures of a film: the line at the top, subtitles, the
// legend of a field, and graphs. None lies over another one.
#pragma once

#include <vector>

#include "render/sticker.h"

namespace supple {

struct OverlayPlaces {
  PixelRect headline, legend, subtitles;  // without size where there is none
  std::vector<PixelRect> graphs;          // of the stage's graphs; empty where there are none, or no room for them

  // Returns the places of all of them but the subtitles, which come and go.
  std::vector<PixelRect> all() const;
};

// Returns the places for a stage. A legend stands at the right edge, in the middle of the height. Graphs stand side by
// side in a corner where they overlap neither the line, the legend nor the subtitles: of such corners, the one where
// they cover the fewest captions, and then least of the bodies' boxes at the start of the film.
OverlayPlaces overlay_places(const Stage& stage);

}  // namespace supple
