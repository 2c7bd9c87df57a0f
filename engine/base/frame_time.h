// Gives the time of a frame, which its caption, the contact sheet, the run's page, tables and files all tell.
#pragma once

#include "base/frame_rate.h"

namespace supple {

// Returns the time after the steps of a frame [s], because its picture shows the bodies as they are then. The film
// starts at time 0 with bodies that no picture shows; frame 0 is at 1 / fps.
inline double frame_time(int frame, const FrameRate& fps) { return fps.time_of(frame + 1LL); }

}  // namespace supple
