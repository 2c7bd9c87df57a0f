#include "sim/elements/element_records.h"

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

}  // namespace

std::vector<ElementRecord> element_records(const TetMesh& mesh, const std::vector<Spring>& springs) {
  std::vector<ElementRecord> records;
  records.reserve(mesh.tets.rows() + springs.size());
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) records.push_back(tetrahedron(mesh, e));
  for (std::size_t s = 0; s < springs.size(); ++s) {
    ElementRecord record{ElementKind::spring, 0, static_cast<std::int32_t>(s)};
    record.corner = {springs[s].from, springs[s].to};
    record.field = {springs[s].length, springs[s].stiffness};
    records.push_back(record);
  }
  return records;
}

std::vector<SystemTerm> system_terms(const ElementRecord& element, double k, const Fibre* fibre) {
  std::vector<SystemTerm> terms;
  if (element.kind == ElementKind::spring) {
    SystemTerm term{{}, element.field[1]};
    term.row[0][0] = -1;
    term.row[1][0] = 1;
    terms.push_back(term);
    return terms;
  }
  double field[Tetrahedron::fields], gradient[4][3];
  std::copy(element.field.begin(), element.field.end(), field);
  Tetrahedron::shape_gradients(field, gradient);
  SystemTerm solid{{}, field[9] * k}, along{{}, fibre != nullptr ? field[9] * fibre->kappa : 0};
  for (int c = 0; c < 4; ++c) {
    for (int i = 0; i < 3; ++i) {
      solid.row[c][i] = gradient[c][i];
      if (fibre != nullptr) along.row[c][0] += gradient[c][i] * fibre->direction[i];
    }
  }
  terms.push_back(solid);
  // The Hessian of a stretched fibre along itself is kappa V (G^T d)(G^T d)^T. docs/results.md says what it is worth in
  // A.
  if (along.weight > 0) terms.push_back(along);
  return terms;
}

}  // namespace supple
