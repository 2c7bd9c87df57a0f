// Makes a drawn surface coarser where a picture would not show the difference. No other part of the program uses
// meshoptimizer.
#pragma once

#include "geometry/skins/skin.h"

namespace supple {

// Returns a part of the skin's triangles, and new ones between the same vertices, that stay within `error` of the
// surface [m]. No triangle becomes longer than about `longest` [m], so that the surface can still bend where the
// elements below it do. Triangles on the border of a colour layer stay as they are, because they carry the border.
//
// colors: the colour of each vertex of the skin; empty: it has none. Triangles stay as they are where a colour would
// change by more than a shade, or a texture would move by more than `error`.
Triangles simplified(const Skin& skin, double error, double longest, const std::vector<PaintLayer>& layers,
                     const std::vector<SurfaceColor>& colors = {});

// Removes the vertices that no triangle uses. Returns the old number of each vertex that is left.
std::vector<std::int32_t> remove_unused_vertices(Skin& skin);

}  // namespace supple
