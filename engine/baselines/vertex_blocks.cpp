#include "baselines/vertex_blocks.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "baselines/chebyshev_weight.h"
#include "baselines/vertex_terms.h"

namespace supple {
namespace {

constexpr int vertices_a_task = 64;

}  // namespace

VertexBlockRule::VertexBlockRule(const Model& model, bool accelerated)
    : accelerated_(accelerated), colors_(vertex_colors(model)), contacts_of_(model.free) {
  std::size_t lanes = 0, vertices = 0;
  for (const VertexColor& color : colors_) {
    lanes = std::max(lanes, std::size_t(color.lanes));
    vertices = std::max(vertices, color.vertices.size());
  }
  numbers_.resize(lanes * corner_numbers);
  partial_.resize(vertices / vertices_a_task + 1);
}

double VertexBlockRule::direction(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  const TimedPhase timed(w.clock, Phase::solve, "sweep");
  x_ = w.current.x;
  if (model.scheme.theta < 1) middle_ = model.scheme.theta * x_ + (1 - model.scheme.theta) * w.start_copy;
  list_contacts(w.current.contacts);
  double slope = 0;
  for (const VertexColor& color : colors_) slope += sweep(model, w, color);
  w.direction = x_.topRows(model.free) - w.current.x.topRows(model.free);
  if (!accelerated_) return slope;
  omega_ = chebyshev_weight(inputs.solver.chebyshev, iteration_, omega_);
  if (iteration_ == 0) return slope;
  for (int v = 0; v < model.free; ++v) {
    if (contacts_of_[v].empty())
      w.direction.row(v) = omega_ * w.direction.row(v) + (omega_ - 1) * (w.current.x.row(v) - before_.row(v));
  }
  return slope;
}

void VertexBlockRule::accepted(const Model&, const StepInputs&, OpenWorkspace& w) {
  before_ = w.current.x;
  ++iteration_;
}

void VertexBlockRule::list_contacts(const std::vector<Contact>& contacts) {
  for (const std::int32_t v : touched_) contacts_of_[v].clear();
  touched_.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const ContactStencil& stencil = contacts[c].stencil;
    for (int k = 0; k < stencil.free; ++k) {
      contacts_of_[stencil.vertex[k]].push_back(static_cast<std::int32_t>(c));
      touched_.push_back(stencil.vertex[k]);
    }
  }
}

// Moves the vertices of a colour; returns what the quadratic models promise, as a slope [J].
double VertexBlockRule::sweep(const Model& model, const OpenWorkspace& w, const VertexColor& color) {
  const double* place = (model.scheme.theta < 1 ? middle_ : x_).data();
  run_chunks(w.threads, static_cast<int>(color.chunks.size()), long(color.lanes) * 16, [&](int c) {
    const CornerChunk& chunk = color.chunks[c];
    local_kernels().corners(chunk.view(model), place, numbers_.data() + std::size_t(chunk.first_lane) * corner_numbers);
  });
  const auto count = static_cast<int>(color.vertices.size());
  const int tasks = (count + vertices_a_task - 1) / vertices_a_task;
  run_chunks(w.threads, tasks, long(color.lanes) * 4, [&](int task) {
    double slope = 0;
    for (int i = task * vertices_a_task; i < std::min(count, (task + 1) * vertices_a_task); ++i)
      slope += move_vertex(model, w, color, i);
    partial_[task] = slope;
  });
  double slope = 0;
  for (int task = 0; task < tasks; ++task) slope += partial_[task];
  return slope;
}

double VertexBlockRule::move_vertex(const Model& model, const OpenWorkspace& w, const VertexColor& color,
                                    std::size_t i) {
  const int v = color.vertices[i];
  const double theta = model.scheme.theta;
  const VertexTerms own = vertex_terms(model, w, x_, v);
  Vec3 slope = own.slope;
  Mat3 block = Mat3::Zero();
  for (std::int32_t k = color.lane_begin[i]; k < color.lane_begin[i + 1]; ++k) {
    const double* number = numbers_.data() + std::size_t(color.lane[k]) * corner_numbers;
    for (int c = 0; c < 3; ++c) slope[c] += number[c];
    for (int row = 0, at = 3; row < 3; ++row) {
      for (int column = 0; column <= row; ++column, ++at) block(row, column) += theta * number[at];
    }
  }
  block.diagonal().array() += own.stiffness;
  add_contacts(w, v, slope, block);
  const Eigen::LLT<Mat3> factor(block);           // reads the lower triangle
  if (factor.info() != Eigen::Success) return 0;  // a number that is not finite: the step's own checks will say so
  const Vec3 move = -factor.solve(slope);
  x_.row(v) += move.transpose();
  if (theta < 1) middle_.row(v) += theta * move.transpose();
  return slope.dot(move);
}

void VertexBlockRule::add_contacts(const OpenWorkspace& w, int vertex, Vec3& slope, Mat3& block) const {
  for (const std::int32_t c : contacts_of_[vertex]) {
    const Contact& contact = w.current.contacts[c];
    const ContactStencil& stencil = contact.stencil;
    double weight = 0;
    for (int k = 0; k < stencil.free; ++k) {
      if (stencil.vertex[k] == vertex) weight = stencil.weight[k];
    }
    const Mat3 along = contact.normal * contact.normal.transpose();
    const double below = gap(contact, x_);
    if (below < 0) {
      slope += weight * 2 * contact.stiffness * below * contact.normal;
      block += weight * weight * 2 * contact.stiffness * along;
    }
    if (contact.friction > 0) {
      const Mat3 across = friction_stiffness(contact, x_) * (Mat3::Identity() - along);
      slope += weight * across * (stencil.at(x_) - contact.origin);
      block += weight * weight * across;
    }
  }
}

}  // namespace supple
