// Tells how thick a sheet is for what touches it: it has a layer on both sides into which contact presses a point, but
// not through the sheet (sheet_pair.h).
#pragma once

namespace supple {

// Returns the thickness of the layer on one side [m]. mean_edge: the mean length of the sheet's edges at rest [m].
inline double sheet_layer(double mean_edge) { return 0.1 * mean_edge; }

}  // namespace supple
