// Defines how search directions are found, by its parts: the matrix from which a direction starts, how systems with it
// are solved, and what an iteration learns from earlier ones. The paper's method and all methods with which it is
// compared are combinations of these parts. Not here: their implementation (solver/lbfgs.h; baselines/make_rule.h).
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/names.h"
#include "sim/model/start_matrix.h"

namespace supple {

enum class LinearSolver { direct, cg };  // by a factor, or by conjugate gradients
template <>
struct Names<LinearSolver> {
  static constexpr std::array table = {Name{LinearSolver::direct, "direct"}, Name{LinearSolver::cg, "cg"}};
};

// Lists the preconditioners of conjugate gradients.
enum class Preconditioner {
  none,    // direct solves have none
  jacobi,  // the matrix's own diagonal
  rest,    // an incomplete Cholesky factor of the rest pose's Hessian
  system,  // an incomplete Cholesky factor of A
};
template <>
struct Names<Preconditioner> {
  static constexpr std::array table = {Name{Preconditioner::none, "none"}, Name{Preconditioner::jacobi, "jacobi"},
                                       Name{Preconditioner::rest, "rest"}, Name{Preconditioner::system, "system"}};
};

// Selects how an iteration learns from earlier ones of the same step.
enum class Acceleration {
  none,
  lbfgs,      // SolverSettings::history pairs
  chebyshev,  // Chebyshev's semi-iterative method (Wang 2015), SolverSettings::chebyshev
  admm,       // multipliers that tie each element's own deformation to the positions (Overby et al. 2017)
};
template <>
struct Names<Acceleration> {
  static constexpr std::array table = {Name{Acceleration::none, "none"}, Name{Acceleration::lbfgs, "l-bfgs"},
                                       Name{Acceleration::chebyshev, "chebyshev"}, Name{Acceleration::admm, "admm"}};
};

// Selects the remedy for a Hessian that is not positive definite.
enum class Safeguard {
  none,        // the matrix is positive definite by itself
  projection,  // each element's Hessian is replaced by the nearest semi-definite one (Teran et al. 2005)
  on_demand,   // projection, only in iterations whose Hessian is not definite as it is (Longva et al. 2023)
  shift,       // a multiple of the identity is added until Cholesky succeeds (Martin et al. 2011)
  curvature,   // conjugate gradients stop where they meet negative curvature (Gast et al. 2015)
};
template <>
struct Names<Safeguard> {
  static constexpr std::array table = {Name{Safeguard::none, "none"}, Name{Safeguard::projection, "projection"},
                                       Name{Safeguard::on_demand, "on-demand"}, Name{Safeguard::shift, "shift"},
                                       Name{Safeguard::curvature, "curvature"}};
};

struct Method {
  StartMatrix matrix = StartMatrix::system;
  LinearSolver linear = LinearSolver::direct;
  int inner_iterations = 0;    // most iterations of conjugate gradients; 0 for direct solves
  double inner_tolerance = 0;  // conjugate gradients also stop once the residual is this share of the right-hand side
  Preconditioner preconditioner = Preconditioner::none;
  Acceleration acceleration = Acceleration::lbfgs;
  Safeguard safeguard = Safeguard::none;

  bool operator==(const Method&) const = default;

  // The usual methods have short names.
  static const Method quasi_newton, projective_dynamics, chebyshev, newton, gast, vertex_block_descent, admm;

  // Returns the paper's method with A solved by conjugate gradients.
  static constexpr Method quasi_newton_cg(int iterations);
  // Returns Newton's method with systems solved by conjugate gradients.
  static constexpr Method newton_cg(int iterations);
  static const Method newton_shifted, newton_on_demand;
  // Returns L-BFGS that starts from another matrix, solved directly.
  static constexpr Method lbfgs_from(StartMatrix matrix);
  // Returns L-BFGS that starts from the Hessian at the first iterate of each step, solved by conjugate gradients.
  static constexpr Method frame_cg(int iterations, Preconditioner preconditioner);
};

inline constexpr Method Method::quasi_newton = {};
inline constexpr Method Method::projective_dynamics = {.acceleration = Acceleration::none};
inline constexpr Method Method::chebyshev = {.acceleration = Acceleration::chebyshev};
inline constexpr Method Method::newton = {
    .matrix = StartMatrix::hessian, .acceleration = Acceleration::none, .safeguard = Safeguard::projection};
inline constexpr Method Method::newton_shifted = {
    .matrix = StartMatrix::hessian, .acceleration = Acceleration::none, .safeguard = Safeguard::shift};
inline constexpr Method Method::newton_on_demand = {
    .matrix = StartMatrix::hessian, .acceleration = Acceleration::none, .safeguard = Safeguard::on_demand};
inline constexpr Method Method::gast = {.matrix = StartMatrix::hessian,
                                        .linear = LinearSolver::cg,
                                        .inner_iterations = 100,  // indefiniteness or the tolerance usually come first
                                        .inner_tolerance = 0.05,
                                        .preconditioner = Preconditioner::jacobi,
                                        .acceleration = Acceleration::none,
                                        .safeguard = Safeguard::curvature};
inline constexpr Method Method::vertex_block_descent = {.matrix = StartMatrix::vertex_blocks,
                                                        .acceleration = Acceleration::chebyshev};
inline constexpr Method Method::admm = {.acceleration = Acceleration::admm};

constexpr Method Method::quasi_newton_cg(int iterations) {
  return {.linear = LinearSolver::cg, .inner_iterations = iterations, .preconditioner = Preconditioner::jacobi};
}

constexpr Method Method::newton_cg(int iterations) {
  return {.matrix = StartMatrix::hessian,
          .linear = LinearSolver::cg,
          .inner_iterations = iterations,
          .preconditioner = Preconditioner::jacobi,
          .acceleration = Acceleration::none,
          .safeguard = Safeguard::projection};
}

constexpr Method Method::lbfgs_from(StartMatrix matrix) { return {.matrix = matrix}; }

constexpr Method Method::frame_cg(int iterations, Preconditioner preconditioner) {
  return {.matrix = StartMatrix::frame_hessian,
          .linear = LinearSolver::cg,
          .inner_iterations = iterations,
          .preconditioner = preconditioner};
}

// Names a method that scene files can select by one word.
struct ShortName {
  std::string_view name;
  Method method;
};
inline constexpr std::array short_names = {
    ShortName{"quasi-newton", Method::quasi_newton},
    ShortName{"projective-dynamics", Method::projective_dynamics},
    ShortName{"chebyshev", Method::chebyshev},
    ShortName{"newton", Method::newton},
    ShortName{"gast", Method::gast},
    ShortName{"vertex-block-descent", Method::vertex_block_descent},
    ShortName{"admm", Method::admm},
};

// Holds up to four values of one part; the first is the default.
template <class E>
class PartChoice {
 public:
  constexpr PartChoice(std::initializer_list<E> values) {
    for (const E value : values) values_[count_++] = value;
  }
  constexpr E usual() const { return values_[0]; }
  constexpr bool contains(E value) const {
    for (const E allowed : *this) {
      if (allowed == value) return true;
    }
    return false;
  }
  constexpr const E* begin() const { return values_.data(); }
  constexpr const E* end() const { return values_.data() + count_; }

 private:
  std::array<E, 4> values_{};
  std::size_t count_ = 0;
};

// Lists the parts that can be combined with a matrix and a linear solver. A pair that is not listed does not exist.
struct MethodForm {
  StartMatrix matrix;
  LinearSolver linear;
  PartChoice<Preconditioner> preconditioner;
  PartChoice<Acceleration> acceleration;
  PartChoice<Safeguard> safeguard;
};

inline constexpr auto method_forms = [] {
  using enum StartMatrix;
  using enum Acceleration;
  constexpr LinearSolver direct = LinearSolver::direct, cg = LinearSolver::cg;
  constexpr Preconditioner without = Preconditioner::none, jacobi = Preconditioner::jacobi;
  constexpr Safeguard definite = Safeguard::none;
  return std::to_array<MethodForm>({
      {system, direct, {without}, {lbfgs, chebyshev, admm, none}, {definite}},
      {system, cg, {jacobi}, {lbfgs, none}, {definite}},
      {identity, direct, {without}, {lbfgs, none}, {definite}},
      {rest_hessian, direct, {without}, {lbfgs, none}, {definite}},
      {warped_rest_hessian, direct, {without}, {lbfgs, none}, {definite}},
      {frame_hessian, direct, {without}, {lbfgs, none}, {definite}},
      {frame_hessian, cg, {Preconditioner::system, Preconditioner::rest}, {lbfgs, none}, {definite}},
      {hessian, direct, {without}, {none}, {Safeguard::projection, Safeguard::on_demand, Safeguard::shift}},
      {hessian, cg, {jacobi}, {none}, {Safeguard::projection, Safeguard::curvature}},
      {vertex_blocks, direct, {without}, {chebyshev, none}, {definite}},
  });
}();

// Returns the parts that can be combined with a matrix and a linear solver; null when systems with the matrix cannot be
// solved in this way.
constexpr const MethodForm* form_of(StartMatrix matrix, LinearSolver linear) {
  for (const MethodForm& form : method_forms) {
    if (form.matrix == matrix && form.linear == linear) return &form;
  }
  return nullptr;
}

// Returns the words for the matrices in the table of forms, each once.
std::vector<std::string> method_matrices();

// Tells why parts cannot be combined.
struct MethodProblem {
  const char* part;     // as scene files call it
  std::string message;  // the part, its value and what is allowed in its place
};
std::optional<MethodProblem> problem_of(const Method& method);

// Returns the name for reports: the short name, or the parts that distinguish the method, as in "frame-hessian, 5 cg
// (rest)".
std::string name_of(const Method& method);

// Returns the method as a scene file spells it: "newton" in quotes, or a table with the parts that are not the default.
std::string spelling_of(const Method& method);

}  // namespace supple
