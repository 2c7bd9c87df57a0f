// One table, one sheet of pictures and one page of all points that have run.
#pragma once

#include "app/sweep/point.h"

namespace supple {

// Writes sweep.csv (what the points gave: the same whoever ran them), times.csv (what the clock said),
// contact-sheet.png where points have pictures, and index.html; tells what is not done and how to repeat it. Returns
// the exit status: 1 unless every point is done. Throws RunError (the disk).
int merge_points(const SweepRequest& request);

}  // namespace supple
