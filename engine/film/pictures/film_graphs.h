// Makes the small graphs that stand in a corner of the pictures, from the rows of the run's profile.
#pragma once

#include <span>
#include <vector>

#include "output/run/profile.h"
#include "render/draw_list.h"

namespace supple {

struct SceneDef;
struct TextDef;

// Holds what the graphs show of a frame.
struct GraphPoint {
  double step_ms;   // of all bodies' steps [ms]
  double estimate;  // the largest of the bodies' error estimates
  double measured;  // the largest of their measured errors; NaN where none is measured
};
GraphPoint graph_point(const FrameRow& row);

// Returns how long all steps of a frame took together, for the frame in which they took longest [ms]. The first frame
// counts only where it is the only one. Returns 0 without rows.
double longest_steps(std::span<const FrameRow> rows);

// Returns the graphs that a scene asks for. longest: the result of longest_steps(), which the scale of times spans
// [ms].
std::vector<GraphLook> graph_looks(const SceneDef& scene, double longest);

// Returns the curves of the graphs up to a frame. earlier: the points of all frames before it; row: the row of the
// frame (null where it is not known, and then there is no curve).
std::vector<GraphCurve> graph_curves(const TextDef& text, std::span<const GraphPoint> earlier, const FrameRow* row,
                                     double longest);

}  // namespace supple
