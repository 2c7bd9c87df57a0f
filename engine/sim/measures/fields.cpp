#include "sim/measures/fields.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/stretches.h"
#include "sim/model/element_view.h"
#include "sim/solver/open_workspace.h"

namespace supple {

double von_mises(const Mat3& f, const Mat3& piola) {
  const double volume = f.determinant();
  if (volume == 0) return std::numeric_limits<double>::quiet_NaN();
  const Mat3 cauchy = piola * f.transpose() / volume;
  const Mat3 deviator = cauchy - cauchy.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

namespace {

// Adds the fields of one material's elements, one by one. kirchhoff: by element, the sum of P F^T over the element and
// its Maxwell arm, by their shares; only used where the model creeps [Pa].
template <class M>
void add_tetrahedra(const Model& model, const Model::ChunkRange& range, const M& material, const Fibre* fibre,
                    const Positions& x, ElementFields& fields, std::vector<Mat3>& kirchhoff) {
  const double weight = !model.creep ? 1 : range.is_arm ? model.creep->share : 1 - model.creep->share;
  for_each_element(model, range, [&](const ElementView& element) {
    const Mat3 f = deformation_gradient(x, as_flowed(model, range, element));
    Matrix3<double> at, stress;
    Mat3 piola;
    for (int i = 0; i < 9; ++i) at.m[i] = f(i / 3, i % 3);
    double density = density_of(material, at, stress);
    if (fibre != nullptr) density += add_fibre(*fibre, at, stress);
    for (int i = 0; i < 9; ++i) piola(i / 3, i % 3) = stress.m[i];
    if (model.creep) kirchhoff[std::size_t(element.input)] += weight * piola * f.transpose();
    fields.energy[element.input] += weight * density;
    if (range.is_arm) return;
    const Svd3<double> parts = svd(at);
    fields.stretch.row(element.input) << parts.s[0], parts.s[1], parts.s[2];
    fields.von_mises[element.input] = von_mises(f, piola);
  });
}

void add_triangles(const Model& model, const Model::ChunkRange& range, const Membrane& membrane, const Positions& x,
                   ElementFields& fields) {
  for_each_element(model, range, [&](const ElementView& element) {
    double corners[3][3], field[Triangle::fields], force[2][3];
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i) corners[k][i] = x(element.corner[k], i);
    }
    std::copy_n(element.field.begin(), Triangle::fields, field);
    const double energy = std::visit(
        [&]<class M>(const M& sheet) { return TriangleFormula<M>(sheet).energy(corners, field, force); }, membrane);
    fields.cloth_energy[element.input] = energy / field[4];
  });
}

void add_springs(const Model& model, const Model::ChunkRange& range, const Positions& x, ElementFields& fields) {
  for_each_element(model, range, [&](const ElementView& element) {
    double ends[2][3], field[SpringElement::fields], force[1][3];
    for (int k = 0; k < 2; ++k) {
      for (int i = 0; i < 3; ++i) ends[k][i] = x(element.corner[k], i);
    }
    std::copy_n(element.field.begin(), SpringElement::fields, field);
    const double energy = SpringElement{}.energy(ends, field, force);
    for (int k = 0; k < 2; ++k) fields.spring_energy[model.input_of[element.corner[k]]] += 0.5 * energy;
  });
}

}  // namespace

ElementFields element_fields(const Model& model, const Positions& x) {
  ElementFields fields;
  int solids = 0, triangles = 0, arms = 0;
  for_each_element(model, [&](const ElementView& element) {
    solids += element.kind == ElementKind::tetrahedron && !element.is_arm;
    arms += element.is_arm;
    triangles += element.kind == ElementKind::triangle;
  });
  fields.stretch.resize(solids, 3);
  fields.von_mises.resize(solids);
  fields.energy.assign(solids, 0.0);
  std::vector<Mat3> kirchhoff(model.creep ? std::size_t(solids) : 0, Mat3::Zero());
  fields.cloth_energy.resize(triangles);
  if (solids + triangles + arms < model.elements) fields.spring_energy.assign(model.vertices, 0.0);
  for (std::size_t c = 0; c < model.chunks.size(); ++c) {
    const Model::ChunkRange& range = model.chunks[c];
    if (range.kind == ElementKind::spring) {
      add_springs(model, range, x, fields);
      continue;
    }
    if (range.kind == ElementKind::triangle) {
      add_triangles(model, range, model.fabrics[range.region].membrane, x, fields);
      continue;
    }
    const Fibre* fibre = model.chunk(static_cast<int>(c)).fibre;
    std::visit([&](const auto& material) { add_tetrahedra(model, range, material, fibre, x, fields, kirchhoff); },
               model.materials[range.region]);
  }
  for (const Model::ChunkRange& range : model.chunks) {
    if (!range.is_arm) continue;
    for_each_element(model, range, [&](const ElementView& element) {
      const double volume = deformation_gradient(x, element).determinant();
      if (volume == 0) return;  // that of the element alone is not defined either
      fields.von_mises[element.input] = von_mises(Mat3::Identity(), kirchhoff[std::size_t(element.input)] / volume);
    });
  }
  return fields;
}

Positions contact_forces(const Model& model, const OpenWorkspace& workspace, const Positions& x) {
  Positions force = Positions::Zero(model.vertices, 3);
  add_contacts(workspace.current.contacts, x, nullptr, workspace.direction, &force, -1);
  return in_input_order(model, force);
}

std::vector<std::array<double, 2>> triangle_stretches(const Positions& rest, const Positions& x,
                                                      const Triangles& triangles) {
  using Edges = Eigen::Matrix<double, 3, 2>;
  const auto edges = [&](const Positions& points, Eigen::Index t) {
    Edges e;
    for (int k = 0; k < 2; ++k) e.col(k) = (points.row(triangles(t, k + 1)) - points.row(triangles(t, 0))).transpose();
    return e;
  };
  std::vector<std::array<double, 2>> stretches(triangles.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    // The squared stretches are the eigenvalues of (E^T E)(R^T R)^-1, with the present edges E and the edges R at rest.
    const Edges r = edges(rest, t), e = edges(x, t);
    stretches[t] = flat_stretches((e.transpose() * e) * (r.transpose() * r).inverse());
  }
  return stretches;
}

}  // namespace supple
