// Implements vertex block descent (Chen, Liu, Yang, Yuksel 2024, "Vertex block descent"): vertex after vertex moves to
// the minimum of the quadratic model of g in its own three coordinates, while all others stay. Vertices of one colour
// share no element and move side by side.
#pragma once

#include "baselines/local_kernels.h"
#include "baselines/vertex_colors.h"
#include "sim/solver/search_rule.h"

namespace supple {

struct Contact;

// An iteration sweeps once over all colours. Its direction leads to where the sweep ends, and is followed to its end.
// Blocks of elements that are not positive semi-definite are projected, so that each system of a vertex is definite.
class VertexBlockRule final : public SearchRule {
 public:
  // accelerated: whether Chebyshev's semi-iterative method moves all vertices that are not in contact.
  VertexBlockRule(const Model& model, bool accelerated);

  void begin(const Model&, const StepInputs&, OpenWorkspace&) override { iteration_ = 0; }
  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;
  void accepted(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;
  bool needs_gradient() const override { return false; }

 private:
  void list_contacts(const std::vector<Contact>& contacts);
  double sweep(const Model& model, const OpenWorkspace& workspace, const VertexColor& color);
  double move_vertex(const Model& model, const OpenWorkspace& workspace, const VertexColor& color, std::size_t i);
  void add_contacts(const OpenWorkspace& workspace, int vertex, Vec3& slope, Mat3& block) const;

  bool accelerated_;
  std::vector<VertexColor> colors_;
  std::vector<double> numbers_;  // by lane of a colour, corner_numbers each
  std::vector<double> partial_;  // slope of each task
  Positions x_;                  // positions in the course of the sweep, n x 3 [m]
  Positions middle_;             // positions where forces are evaluated, n x 3 [m]; empty where these are x_
  std::vector<std::vector<std::int32_t>> contacts_of_;  // by free vertex; empty without contacts
  std::vector<std::int32_t> touched_;                   // the vertices that have contacts
  int iteration_ = 0;
  double omega_ = 1;
  Positions before_;  // the iterate before the current one, n x 3 [m]
};

}  // namespace supple
