// Draws the legend of a field (a bar with the field's colours, its values beside it and its name above), and the line
// at the top of a picture.
#pragma once

#include "render/sticker.h"

namespace supple {

// Makes the legend for a picture of this height [pixels]; it is empty when the field has no title or there is no font.
Sticker legend_of(const FieldLook& field, const std::string& font, int height);

// Returns where the legend stands in a picture: at the right edge, in the middle of the height.
PixelRect legend_place(const Sticker& legend, int width, int height);

// Makes the line that stands in the upper left corner.
Sticker headline_of(const std::string& text, const std::string& font, int height, const Vec3& color);

// Returns the colour of letters on the stage's background: dark ones, or light ones where that is dark [sRGB].
Vec3 ink_on(const Stage& stage);

}  // namespace supple
