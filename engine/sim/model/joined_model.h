// Joins the models of bodies that touch each other into one, whose parts they are, so that their steps are made
// together. Nothing is computed or factored anew: the elements and the factors of the bodies follow one another. Not
// here: what the parts do to each other (contact/surface_contacts.h), which bodies are joined (world/island_finder.h).
#pragma once

#include <vector>

#include "sim/model/model.h"
#include "sim/model/state.h"

namespace supple {

// Returns the model of several bodies. Its free vertices are those of the first body, then of the second, and so on;
// then come the held ones in the same order. Vertices of the input file, handles and regions are numbered as if the
// bodies' own followed one another in one file. The bodies must have one time step, integrator and precision. What has
// flowed in them comes with show_flow() (flow_step.h).
Model join(const std::vector<const Model*>& bodies);

// Returns the number that a vertex of a body has in the joined model. part: that of the body.
inline std::int32_t joined_vertex(const Part& part, std::int32_t vertex) {
  return vertex < part.free ? part.first_free + vertex : part.first_held + (vertex - part.free);
}

// Returns the number that a vertex of the joined model has in its body's own model. part: that of the body.
inline std::int32_t own_vertex(const Model& joined, const Part& part, std::int32_t vertex) {
  return vertex < joined.free ? vertex - part.first_free : vertex - part.first_held + part.free;
}

// Returns the rows of a part (its vertices x 3, in the order of its own model) among those of a joined model.
Positions rows_of(const Part& part, const Positions& joined);
// Writes the rows of a part to their places among those of a joined model.
void set_rows(const Part& part, const Positions& rows, Positions& joined);

}  // namespace supple
