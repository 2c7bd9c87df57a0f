// States in one line which stage of a frame costs most, and what makes that stage cheaper. All texts of this kind are
// here.
#pragma once

#include <string>
#include <vector>

#include "output/run/profile.h"
#include "output/run/zones.h"

namespace supple {

// Holds the work for a frame by stage, averaged over all frames but the first, in milliseconds; 0: there is no such
// stage. The stages run at the same time, so a frame takes less than their sum.
struct FrameWork {
  double solving = 0;      // steps, and what a replay changes
  double drawing = 0;      // draw list and picture
  double compressing = 0;  // of the picture's file
  double encoding = 0;     // of the film: processor time of the encoder
};

// Returns the work of rows. encoding: the encoder's time for a frame, which no row contains.
FrameWork work_of(const std::vector<FrameRow>& rows, double encoding);
// Returns the work of a profile, averaged over its repeats as well. A profiled run makes no film.
FrameWork work_of(const ZoneProfile& profile);

// Returns a text such as "drawing is 71 % of the work for a frame (...): fewer samples, ... help"; empty where nothing
// took any time.
std::string verdict(const FrameWork& work);

}  // namespace supple
