#include "sim/elements/element_records.h"

#include <algorithm>
#include <cmath>

namespace supple {
namespace {

ElementRecord tetrahedron(const TetMesh& mesh, Eigen::Index e) {
  ElementRecord record{ElementKind::tetrahedron, mesh.regions.empty() ? 0 : mesh.regions[e],
                       static_cast<std::int32_t>(e)};
  double rest[4][3];
  for (int k = 0; k < 4; ++k) {
    record.corner[k] = mesh.tets(e, k);
    for (int c = 0; c < 3; ++c) rest[k][c] = mesh.rest(mesh.tets(e, k), c);
  }
  double field[Tetrahedron::fields];
  Tetrahedron::fill(rest, field);
  std::copy(field, field + Tetrahedron::fields, record.field.begin());
  return record;
}

void shape_gradients(const ElementRecord& element, std::array<std::array<double, 3>, most_corners>& rows) {
  double field[Tetrahedron::fields], gradient[4][3];
  std::copy(element.field.begin(), element.field.end(), field);
  Tetrahedron::shape_gradients(field, gradient);
  for (int c = 0; c < 4; ++c) std::copy(gradient[c], gradient[c] + 3, rows[c].begin());
}

}  // namespace

std::vector<ElementRecord> element_records(const TetMesh& mesh, const std::vector<Spring>& springs,
                                           const std::vector<FlatTriangle>& triangles) {
  std::vector<ElementRecord> records;
  records.reserve(mesh.tets.rows() + springs.size() + triangles.size());
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) records.push_back(tetrahedron(mesh, e));
  for (std::size_t s = 0; s < springs.size(); ++s) {
    ElementRecord record{ElementKind::spring, 0, static_cast<std::int32_t>(s)};
    record.corner = {springs[s].from, springs[s].to};
    record.field = {springs[s].length, springs[s].stiffness};
    records.push_back(record);
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    ElementRecord record{ElementKind::triangle, 0, static_cast<std::int32_t>(t)};
    std::copy(triangles[t].corner.begin(), triangles[t].corner.end(), record.corner.begin());
    double field[Triangle::fields];
    Triangle::fill(triangles[t].edges, field);
    std::copy(field, field + Triangle::fields, record.field.begin());
    records.push_back(record);
  }
  return records;
}

SystemTerm unit_term(const ElementRecord& element) {
  if (element.kind == ElementKind::spring) {
    SystemTerm term{{}, 1};
    term.row[0][0] = -1;
    term.row[1][0] = 1;
    return term;
  }
  if (element.kind == ElementKind::triangle) return membrane_term(element, {{1, 1}});
  SystemTerm term{{}, element.field[9]};
  shape_gradients(element, term.row);
  return term;
}

SystemTerm membrane_term(const ElementRecord& element, const MembraneStiffness& stiffness) {
  SystemTerm term{{}, element.field[4]};
  double gradient[3][2];
  Triangle::shape_gradients(element.field.data(), gradient);
  for (int c = 0; c < 3; ++c) {
    for (int j = 0; j < 2; ++j) term.row[c][j] = std::sqrt(stiffness.along[j]) * gradient[c][j];
  }
  return term;
}

// The Hessian of a stretched fibre along itself is kappa V (G^T d)(G^T d)^T. How much this term in A gains is in
// docs/lab/2026-11-22-films-of-the-paper.md ("Fibres in the system matrix").
SystemTerm fibre_term(const ElementRecord& element, const Fibre& fibre) {
  std::array<std::array<double, 3>, most_corners> gradient;
  shape_gradients(element, gradient);
  SystemTerm term{{}, element.field[9] * fibre.kappa};
  for (int c = 0; c < 4; ++c) {
    for (int i = 0; i < 3; ++i) term.row[c][0] += gradient[c][i] * fibre.direction[i];
  }
  return term;
}

}  // namespace supple
