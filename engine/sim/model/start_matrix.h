// Names the matrices from which search directions start: approximations of the Hessian of g. These words are the same
// for the quasi-Newton method, whose matrix is SolverSettings::matrix, and for the methods with which it is compared,
// whose matrix is a part of a Method.
#pragma once

#include <algorithm>
#include <array>

#include "base/names.h"

namespace supple {

enum class StartMatrix {
  system,               // A = M/h^2 + L, constant: the paper's
  tangent,              // a matrix for all coordinates that follows the body (model/tangent_system.h)
  turned_hessian,       // the Hessian of some pose, turned with the body (model/turned_hessian_system.h)
  identity,             // (t.t / s.t) I of the last L-BFGS pair (equation 13)
  rest_hessian,         // M/h^2 + the Hessian of the rest pose
  warped_rest_hessian,  // the same, turned at each vertex by its rotation (Mueller et al. 2002)
  frame_hessian,        // the projected Hessian at the first iterate of each search
  hessian,              // the Hessian at each iterate: Newton's method
  vertex_blocks,        // the Hessian's 3 x 3 block of each vertex, when its turn comes (Chen et al. 2024)
};
template <>
struct Names<StartMatrix> {
  static constexpr std::array table = {Name{StartMatrix::system, "system"},
                                       Name{StartMatrix::tangent, "tangent"},
                                       Name{StartMatrix::turned_hessian, "turned-hessian"},
                                       Name{StartMatrix::identity, "identity"},
                                       Name{StartMatrix::rest_hessian, "rest-hessian"},
                                       Name{StartMatrix::warped_rest_hessian, "warped-rest-hessian"},
                                       Name{StartMatrix::frame_hessian, "frame-hessian"},
                                       Name{StartMatrix::hessian, "hessian"},
                                       Name{StartMatrix::vertex_blocks, "vertex-blocks"}};
};

// Lists the matrices of the quasi-Newton method. Those of the methods with which it is compared are in method_forms.
inline constexpr std::array quasi_newton_matrices = {StartMatrix::system, StartMatrix::tangent,
                                                     StartMatrix::turned_hessian};

constexpr bool is_of_quasi_newton(StartMatrix matrix) {
  return std::find(quasi_newton_matrices.begin(), quasi_newton_matrices.end(), matrix) != quasi_newton_matrices.end();
}

}  // namespace supple
