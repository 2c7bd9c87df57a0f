#include "sim/model/turned_hessian_system.h"

#include "base/error.h"
#include "base/trace.h"
#include "sim/linear/changing_factor.h"
#include "sim/model/elastic_hessian.h"
#include "sim/model/element_view.h"
#include "sim/model/stiffness_sample.h"
#include "sim/model/system_solve.h"
#include "sim/model/vertex_rotations.h"

namespace supple {
namespace {

// The share of A in the matrix. It keeps the matrix positive definite and directions bounded where a material has no
// stiffness in the present pose; a larger share slows convergence (docs/lab/2026-11-24-matrices.md).
constexpr double share_of_constant = 0.02;

// Returns the share of A for a material. A strain limit has no stiffness until it acts, and then all of it at once: its
// Hessian does not foretell the stiffness that a step meets, so A takes its place.
double share_of_constant_for(const Material& material) {
  return std::holds_alternative<StrainLimiting>(material) ? 1.0 : share_of_constant;
}

// Mixes an element's share of L, which is the same for x, y and z, into its packed matrix (element_kernels.h).
void mix(double* packed, const SystemTerm& term, int corners, double share) {
  for (int i = 0; i < 3 * (corners - 1); ++i) {
    double* row = packed + i * (i + 1) / 2;
    for (int j = 0; j <= i; ++j) {
      row[j] *= 1 - share;
      if (i % 3 != j % 3) continue;
      const auto &a = term.row[1 + i / 3], &b = term.row[1 + j / 3];
      row[j] += share * term.weight * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    }
  }
}

}  // namespace

struct TurnedHessianSystem::Parts {
  // The ids of the structure and the model for which the numbers were made.
  std::uint64_t structure = 0, model = 0;
  Positions x;

  ElementMatrices elements;
  ElasticHessian hessian;
  ChangingFactor factor;
  StiffnessSample sample;
  VertexRotations rotations;
  Rotations made_back;          // rotations from where the matrix was made to rest
  Rotations since, since_back;  // rotations from where it was made to where it is turned to, and back
  Positions right;              // n_free x 3

  explicit Parts(const Model& of)
      : structure(of.structure),
        hessian(of),
        factor(of.factor.precision()),
        sample(of),
        rotations(of),
        right(of.free, 3) {
    factor.analyze(hessian.matrix());
  }
  void mix_elements(const Model& of);
};

void TurnedHessianSystem::Parts::mix_elements(const Model& of) {
  for (std::size_t c = 0; c < of.chunks.size(); ++c) {
    const Model::ChunkRange& range = of.chunks[c];
    const bool solid = range.kind == ElementKind::tetrahedron;
    const double share = solid ? share_of_constant_for(of.materials[range.region]) : share_of_constant;
    for_each_element(of, range, [&](const ElementView& element) {
      const std::size_t lane = std::size_t(element.lane) - std::size_t(range.first_block) * block_width;
      mix(&elements.numbers[elements.first[c] + lane * stiffness_numbers(range.kind)], of.system_term(element),
          corners_of(range.kind), share);
    });
  }
}

TurnedHessianSystem::TurnedHessianSystem() = default;
TurnedHessianSystem::~TurnedHessianSystem() = default;
TurnedHessianSystem::TurnedHessianSystem(TurnedHessianSystem&&) noexcept = default;
TurnedHessianSystem& TurnedHessianSystem::operator=(TurnedHessianSystem&&) noexcept = default;

bool TurnedHessianSystem::make(const Model& model, const Positions& x, Threads* threads) {
  SUPPLE_CHECK(x.rows(), ==, model.vertices);
  if (parts_ && parts_->model == model.id && parts_->x == x) return true;
  const Zone zone("renew matrix");
  if (!parts_ || parts_->structure != model.structure || parts_->factor.precision() != model.factor.precision())
    parts_ = std::make_unique<Parts>(model);
  Parts& p = *parts_;
  p.model = 0;  // stays 0 until the matrix is made
  p.x = x;
  element_matrices(model, threads, x, true, p.elements);
  p.mix_elements(model);
  p.hessian.assemble(model, p.elements);
  p.sample.take(model, x, {});
  p.rotations.find(x, threads, p.since);
  transpose(p.since, p.made_back);
  if (!p.factor.factorize(p.hessian.matrix())) return false;
  p.model = model.id;
  return true;
}

double TurnedHessianSystem::departure(const Model& model, const Positions& x) const {
  SUPPLE_CHECK(parts_->model, ==, model.id);
  return parts_->sample.departure(model, x);
}

void TurnedHessianSystem::turn_to(const Positions& x, Threads* threads) {
  Parts& p = *parts_;
  p.rotations.find(x, threads, p.since);
  multiply(p.since, p.made_back, p.since);
  transpose(p.since, p.since_back);
}

// Computes z, the sum of P R H^-1 R^T P^T r and the motion that r gives to the centre of mass: symmetric, as L-BFGS
// needs it. P = 1 - 1 1^T M / m takes the motion of the centre of mass out of a motion, for each part that nothing
// holds, with m its mass.
void TurnedHessianSystem::solve(const Model& model, const Positions& r, Positions& z) {
  Parts& p = *parts_;
  p.right = r;
  for (const Part& part : model.parts) {
    if (!part.floats) continue;
    const Eigen::RowVector3d mean = r.middleRows(part.first_free, part.free).colwise().sum() / part.mass;
    for (int v = part.first_free; v < part.first_free + part.free; ++v) p.right.row(v) -= model.mass[v] * mean;
  }
  turn_back(p.since, p.right, p.right);
  p.factor.solve(p.right.data(), p.right.data());
  turn_back(p.since_back, p.right, z);
  restore_translation(model, r, z);
}

double TurnedHessianSystem::renewal_cost(const Model& model) const {
  return cost_of_hessian(model, parts_->factor.operations());
}

// An evaluation has about 450 operations an element (`supple bench roofline`), and the second derivatives with their
// sums take as long as 20 evaluations.
double cost_of_hessian(const Model& model, double factor_operations) {
  return 20 + factor_operations / (450.0 * model.elements);
}

std::int64_t TurnedHessianSystem::stored_numbers() const { return parts_ ? parts_->factor.stored_numbers() : 0; }

}  // namespace supple
