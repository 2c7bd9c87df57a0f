// Holds what the solver remembers of the earlier steps of a body, as a part of its State. Only the rules of the matrix
// (solver/matrix_rule.h) and of the precision (solver/element_precision.h) read and write what is in it; everybody else
// copies it, and files keep its bytes.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/types.h"

namespace supple {

struct SolverMemory {
  Positions matrix_made_at;  // where the matrix of directions was made, n x 3; empty: none was [m]
  int matrix_age = 0;        // steps since the matrix was made
  // turned_hessian_progress: the factor by which one evaluation reduced the error (the estimate of the error to the
  // power of one over the number of evaluations) in the last step that started directions from the turned Hessian.
  // system_progress: the same of A, from its last step without contacts; each step in which the turned Hessian serves
  // moves it a tenth of the way to 0.25. 0: not known.
  double turned_hessian_progress = 0, system_progress = 0;
  bool began_in_single = false;  // the first direction of the last step promised enough for single precision
};

// Returns the memory as bytes, for files that a program of the same version reads on a machine with the same order of
// bytes.
std::string bytes_of(const SolverMemory& memory);

// Returns the memory that bytes_of() wrote; nothing where the bytes are not of a body with this many vertices.
std::optional<SolverMemory> memory_from(std::string_view bytes, Eigen::Index vertices);

}  // namespace supple
