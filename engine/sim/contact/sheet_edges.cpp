#include "sim/contact/sheet_edges.h"

#include <algorithm>

namespace supple {

bool SheetEdges::are_asked(const Model& model, const StepInputs& inputs, std::size_t meeting) {
  const Meeting& own = inputs.meetings[meeting];
  return !own.is_own() && own.points < own.surface && !model.parts[own.points].solid && !model.parts[own.surface].solid;
}

SheetEdges::SheetEdges(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                       const Positions& y, const Positions& x, const Work& work)
    : TouchedEdges(model, inputs, inputs.meetings[meeting], q, y, x, work,
                   0.5 * std::min(work.surfaces[inputs.meetings[meeting].points].layer,
                                  work.surfaces[inputs.meetings[meeting].surface].layer)),
      own_(work.surfaces[meeting_.points]) {}

void SheetEdges::find(std::size_t index, std::vector<Contact>& list) const {
  const EdgeEnds& edge = own_.edges[index];
  const double reach = std::min(reach_of_edge(edge), layer_) + layer_;
  visit_edges_near(edge, reach, [&](std::size_t other) { add_edges(edge, surface_.edges[other], reach, list); });
}

double SheetEdges::share_to_impact(std::size_t index, double least) const {
  const EdgeEnds& edge = own_.edges[index];
  visit_edges_near(
      edge, 0, [&](std::size_t other) { least = TouchedEdges::share_to_impact(edge, surface_.edges[other], least); });
  return least;
}

}  // namespace supple
