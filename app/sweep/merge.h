// Merges all points that have run into one table, one sheet of pictures and one page.
#pragma once

#include "app/sweep/point.h"

namespace supple {

// Writes sweep.csv (the results of the points, which are the same on every run), times.csv (the measured times),
// contact-sheet.png where points have pictures, and index.html. Prints which points are not done and how to repeat
// them. Returns the exit status: 1 unless every point is done. Throws RunError when a file cannot be written.
int merge_points(const SweepRequest& request);

}  // namespace supple
