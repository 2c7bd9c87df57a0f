// Lists hard cases of bodies that meet: bodies that start in each other, one that others squeeze, bodies of unlike
// stiffness or density on each other, and fast impacts. Each case has rules that its runs must keep. Not here: hard
// cases of one body (hard_cases.h), and how a case is played (meeting_run.h).
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/types.h"

namespace supple {

struct MeetingCase {
  std::string name;
  // The texts of its scenes, one for each run. MATERIAL stands for the table of each body in turn; the number of
  // substeps is written before the text.
  std::vector<std::string> scenes;
  std::vector<double> stiffness = {};  // of each body, over the usual one; 1 for those beyond the list
  bool stays_whole = true;             // nothing is inverted or without volume at the end
  bool comes_to_rest = false;          // at the end nothing moves but slowly
  // The direction in which each body lies from the one before it, at the ends of the first frames; zero: any. A body
  // that is further beside the other than `around` has not passed through it, but fallen or flown around it.
  Vec3 order = Vec3::Zero();
  double around = 0.15;  // [m]
  int ordered_frames = std::numeric_limits<int>::max();
  double alone_from = 0;  // from this time on, nothing does work on the bodies from outside [s]
};

// Returns all cases.
std::vector<MeetingCase> meeting_cases();

// The numbers of substeps and the materials (stability_materials) with which each case is played.
inline constexpr int meeting_substeps[] = {1, 30};
inline constexpr const char* meeting_materials[] = {"stable-neo-hookean", "corotated", "st-venant-kirchhoff"};

}  // namespace supple
