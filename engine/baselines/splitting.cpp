#include "baselines/splitting.h"

#include "baselines/vertex_terms.h"

namespace supple {

void SplittingRule::begin(const Model& model, const StepInputs&, OpenWorkspace&) {
  multipliers_.resize(std::size_t(model.blocks) * most_multipliers * block_width);
  start_ = true;
}

double SplittingRule::direction(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  const TimedPhase timed(w.clock, Phase::solve, "splitting");
  make_local_steps(model, w);
  // The slope of the global step's quadratic energy at the current iterate.
  Positions& slope = w.scratch;
  for (int v = 0; v < model.free; ++v) {
    Vec3 sum = vertex_terms(model, w, w.current.x, v).slope;
    for (std::int32_t s = model.slot_begin[v]; s < model.slot_begin[v + 1]; ++s) {
      const double* force = w.force.data() + 3 * std::size_t(model.slots[s]);
      for (int c = 0; c < 3; ++c) sum[c] += force[c];
    }
    slope.row(v) = sum.transpose();
  }
  if (!w.current.contacts.empty()) add_contacts(w.current.contacts, w.current.x, nullptr, w.direction, &slope);
  find_stiff_directions(model, w.current.contacts, w.current.x, w.correction);
  const Positions kept = slope;
  apply_inverse(model, inputs.solver.contact, w.correction, w.solve_scratch, slope, w.direction);
  w.direction = -w.direction;
  return (kept.array() * w.direction.array()).sum();
}

void SplittingRule::make_local_steps(const Model& model, OpenWorkspace& w) {
  const double theta = model.scheme.theta;
  if (theta < 1) w.middle = theta * w.current.x + (1 - theta) * w.start_copy;
  const double* place = (theta < 1 ? w.middle : w.current.x).data();
  run_chunks(w.threads, static_cast<int>(model.chunks.size()), long(model.elements) * 40, [&](int c) {
    const Model::ChunkRange& range = model.chunks[c];
    const double k = range.kind == ElementKind::tetrahedron ? model.stiffness[range.region].k : 0;
    local_kernels().proximal(model.chunk(c), k, place, start_,
                             multipliers_.data() + std::size_t(range.first_block) * most_multipliers * block_width,
                             w.force.data() + 3 * std::size_t(range.first_vertex));
  });
  start_ = false;
}

}  // namespace supple
