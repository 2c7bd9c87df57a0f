// Merges all points that have run into one table, one sheet of pictures and one page.
#pragma once

#include "app/sweep/point.h"

namespace supple {

// Writes sweep.csv (what the points gave, which is the same on every run), times.csv (what the clock said),
// contact-sheet.png where points have pictures, and index.html; tells what is not done and how to repeat it. Returns
// the exit status: 1 unless every point is done. Throws RunError (the disk).
int merge_points(const SweepRequest& request);

}  // namespace supple
