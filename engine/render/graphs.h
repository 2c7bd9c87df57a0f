// Lays small graphs over a picture, in one of its corners: a curve that grows with the film, and its scale.
#pragma once

#include <vector>

#include "render/sticker.h"

namespace supple {

// Returns the sizes that the stage's graphs have in its pictures [pixels]: width and height, no place yet. Empty when
// there are no graphs or no font.
std::vector<PixelRect> graph_sizes(const Stage& stage);

class Graphs {
 public:
  // places: the places of the stage's graphs, with their sizes; empty where they have no room, and then nothing is
  // drawn.
  Graphs(const Stage& stage, std::vector<PixelRect> places);

  // Draws the curves over a picture.
  void draw(Image& image, const std::vector<GraphCurve>& curves) const;

 private:
  std::vector<GraphLook> graphs_;
  std::vector<PixelRect> places_;
  std::vector<Sticker> plates_;    // the graphs without their curves
  std::vector<PixelRect> inside_;  // where the curves are, in the plates
};

}  // namespace supple
