// Draws the legend of a field (a bar with the field's colours, its values beside it and its name above), and the line
// at the top of a picture.
#pragma once

#include "render/sticker.h"

namespace supple {

// Makes the legend for a picture of this size [pixels]; it is empty when the field has no title or there is no font. It
// stands beside the bodies, so that a narrow picture has a small one.
Sticker legend_of(const FieldLook& field, const Font& font, int width, int height);

// Returns how far a legend stays away from the picture's edges [pixels].
int legend_margin(const Stage& stage);

// Returns the share of the picture's width that the legend of the stage's field takes with its margin; 0 without one.
double legend_room(const Stage& stage);

// Makes the line that stands in the upper left corner. Its letters are so small that the stage's longest line has room.
Sticker headline_of(const Stage& stage, const std::string& text);

// Returns how far the headline and the graphs stay away from the picture's edges [pixels].
int overlay_margin(const Stage& stage);

// Returns the colour of letters on the stage's background: dark ones, or light ones where that is dark [sRGB].
Vec3 ink_on(const Stage& stage);

}  // namespace supple
