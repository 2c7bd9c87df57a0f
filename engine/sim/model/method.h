// The closed set of solvers by name: the paper's method, and what it is compared with. Not here: how they work
// (lbfgs.h; baselines/make_rule.h).
#pragma once

#include <array>
#include <string_view>

namespace supple {

enum class Method {
  quasi_newton,
  projective_dynamics,
  chebyshev,
  newton,
  newton_shifted,
  newton_cg5,
  newton_cg15,
  gast,
  quasi_newton_cg5,
  quasi_newton_cg15,
  lbfgs_identity,
  lbfgs_rest,
  lbfgs_warped,
  lbfgs_frame,
  lbfgs_frame_cg5_rest,
  lbfgs_frame_cg15_rest,
  lbfgs_frame_cg5_ours,
  lbfgs_frame_cg15_ours,
  hecht,
  contact_matrix,
};

struct MethodInfo {
  Method method;
  std::string_view name;     // in scene files and tables
  std::string_view meaning;  // one line
};

constexpr std::array methods = {
    MethodInfo{Method::quasi_newton, "quasi-newton", "L-BFGS from M/h^2 + L: the paper's"},
    MethodInfo{Method::projective_dynamics, "projective-dynamics", "M/h^2 + L alone"},
    MethodInfo{Method::chebyshev, "chebyshev", "M/h^2 + L with Chebyshev acceleration (Wang 2015)"},
    MethodInfo{Method::newton, "newton", "Newton, element Hessians projected, direct solve"},
    MethodInfo{Method::newton_shifted, "newton-shifted", "Newton with a multiple of the identity, direct solve"},
    MethodInfo{Method::newton_cg5, "newton-cg5", "projected Newton, 5 conjugate gradients (Jacobi)"},
    MethodInfo{Method::newton_cg15, "newton-cg15", "projected Newton, 15 conjugate gradients (Jacobi)"},
    MethodInfo{Method::gast, "gast", "Newton, conjugate gradients stopped at indefiniteness (Gast et al. 2015)"},
    MethodInfo{Method::quasi_newton_cg5, "quasi-newton-cg5", "the paper's, M/h^2 + L by 5 conjugate gradients"},
    MethodInfo{Method::quasi_newton_cg15, "quasi-newton-cg15", "the paper's, M/h^2 + L by 15 conjugate gradients"},
    MethodInfo{Method::lbfgs_identity, "lbfgs-identity", "L-BFGS from a scaled identity (equation 13)"},
    MethodInfo{Method::lbfgs_rest, "lbfgs-rest", "L-BFGS from the Hessian of the rest pose"},
    MethodInfo{Method::lbfgs_warped, "lbfgs-warped", "the same, warped by each vertex' rotation (Mueller et al. 2002)"},
    MethodInfo{Method::lbfgs_frame, "lbfgs-frame", "L-BFGS from the Hessian at the frame's start, direct solve"},
    MethodInfo{Method::lbfgs_frame_cg5_rest, "lbfgs-frame-cg5-rest",
               "the same by 5 conjugate gradients, incomplete Cholesky of the rest pose's"},
    MethodInfo{Method::lbfgs_frame_cg15_rest, "lbfgs-frame-cg15-rest",
               "the same by 15 conjugate gradients, incomplete Cholesky of the rest pose's"},
    MethodInfo{Method::lbfgs_frame_cg5_ours, "lbfgs-frame-cg5-ours",
               "the same by 5 conjugate gradients, incomplete Cholesky of M/h^2 + L"},
    MethodInfo{Method::lbfgs_frame_cg15_ours, "lbfgs-frame-cg15-ours",
               "the same by 15 conjugate gradients, incomplete Cholesky of M/h^2 + L"},
    MethodInfo{Method::hecht, "hecht", "warped Hessian renewed every other step (Hecht et al. 2012)"},
    MethodInfo{Method::contact_matrix, "contact-matrix", "the paper's, contacts in the matrix, factored anew"},
};

// Whether a step depends on earlier ones by more than the state.
constexpr bool remembers_steps(Method method) { return method == Method::hecht; }

constexpr const MethodInfo& info_of(Method method) { return methods[static_cast<std::size_t>(method)]; }

}  // namespace supple
