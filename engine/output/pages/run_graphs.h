// Makes the graphs on the page of a run: values by frame, and their picture as HTML with SVG, to which the page's
// script adds a cursor.
#pragma once

#include <string>
#include <vector>

#include "output/run/profile.h"

namespace supple {

// Holds a value for each frame; NaN where a frame has none.
struct FrameSeries {
  std::string name;
  std::vector<double> values;
};

struct FrameGraph {
  std::string title, unit;
  bool logarithmic = false;
  std::vector<FrameSeries> series;
  bool first_apart = false;  // the first frame may leave the axis: it compiles shaders and warms caches
};

// Returns the graphs for which the rows have values: times, errors, stretch, contacts of each body and its depth in
// colliders, and contacts and depths of pairs of bodies. There must be rows.
std::vector<FrameGraph> graphs_of(const std::vector<FrameRow>& rows);

// Returns a graph as HTML. first: the number of its first series on the page, for the script. from, to: the times of
// the first and the last frame [s].
std::string graph_html(const FrameGraph& graph, std::size_t first, double from, double to);

}  // namespace supple
