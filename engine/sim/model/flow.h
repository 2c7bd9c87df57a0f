// Describes how solids keep a new shape. F = F_e F_p in each tetrahedron (Bargteil, Wojtan, Hodgins, Turk 2007, "A
// finite element method for animating large viscoplastic flow"): only F_e is strained elastically, and F_p, of
// determinant 1, is the shape that the element keeps. It is a part of the State, is constant within a step, and changes
// between two steps (flow_step.h). Not here: the rules by which it changes (elements/element_flow.h).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

// Holds what has flowed in a body. Lists are by tetrahedron of the input; they stay empty where a body has no such
// flow.
struct Flow {
  std::vector<double> plastic;   // F_p, nine entries by rows
  std::vector<double> hardened;  // plastic strain that has added up: the sum of von Mises' equivalents by step
  std::vector<double> viscous;   // F_v of the Maxwell arm, nine entries by rows
  double until = 0;              // the time up to which the body has flowed [s]
  double lost = 0;               // elastic energy that flow has taken since the start [J]

  bool empty() const { return plastic.empty() && viscous.empty(); }
};

// Returns the flow as bytes, for files that a program of the same version reads on a machine with the same order of
// bytes; none where it is empty.
std::string bytes_of(const Flow& flow);

// Returns the flow that bytes_of() wrote; nothing where the bytes are damaged.
std::optional<Flow> flow_from(std::string_view bytes);

}  // namespace supple
