// Computes the numbers of a model that its structure does not fix: materials, masses, stiffnesses, time step, and what
// follows from them, A and its factor. They are computed when a model is built, and again when a parameter changes
// while the body moves.
#pragma once

#include "sim/elements/element_records.h"
#include "sim/model/model.h"

namespace supple {

// These functions return numbers that no structure and no values of a model have had yet (Model::structure,
// System::id).
std::uint64_t new_structure();
std::uint64_t new_values();

class ModelValues {
 public:
  // Takes a model whose vertices are numbered. Sorts the elements by kind and region, then by first vertex, with
  // corners in the model's numbering.
  ModelValues(const Model& model, const BodyDescription& body);

  const std::vector<ElementRecord>& elements() const { return elements_; }

  // Sets all that follows from the present description; numbering and packing stay. What has flowed is forgotten until
  // show_flow() gives it to the model again. The mesh, the ends of springs, the triangles and seams of cloth, the
  // vertices and hardness of handles, whether the body creeps, and whether cloth is curved or bends at all, must be as
  // in the description from which the model was built. Throws RunError when A cannot be factored; the model must then
  // not be used for steps.
  void set(Model& model, const BodyDescription& body);

 private:
  void add_up_elastic(Model& model);
  void add_bending(Model& model);
  void add_seams(Model& model);
  Eigen::SparseMatrix<double> system_matrix(Model& model, double damping) const;

  std::vector<ElementRecord> elements_;
  Eigen::SparseMatrix<double> elastic_;       // L over all vertices, both triangles [N/m]
  Eigen::SparseMatrix<double> unit_bending_;  // Q for a bending stiffness of 1 N m; empty without bending [1/m^2]
  RestCurvature unit_curvature_;              // the same of cloth that is curved at rest; else empty
  std::vector<std::int32_t> place_;           // place of each element's pairs of corners among elastic_'s numbers
  std::vector<double> share_;  // what each pair adds at its place, for k = 1 [m], or a spring's stiffness of 1
};

}  // namespace supple
