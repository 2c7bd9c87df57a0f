// Provides a body among colliders, and what its steps need, for tests and studies of contact.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "geometry/tetrahedra/tetrahedralize.h"
#include "sim/solver/step.h"
#include "support/bodies.h"
#include "support/sparse_matrices.h"

namespace supple::test {

inline Shape shape_of(const Primitive& primitive) {
  Shape shape;
  shape.root.parts.push_back({primitive});
  return shape;
}

inline Eigen::Isometry3d moved_to(const Vec3& place) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = place;
  return pose;
}

// Makes a cube of n cells a side, 0.2 m wide, centred at the origin.
inline BodyDescription cube(int cells, const Material& material = Corotated{3e4, 6e4}) {
  BodyDescription body;
  body.name = "cube";
  body.mesh = box_mesh(Vec3(0.2, 0.2, 0.2), Eigen::Vector3i::Constant(cells));
  body.mesh.rest.rowwise() -= Eigen::RowVector3d(0.1, 0.1, 0.1);
  body.materials = {material};
  body.precision = Precision::double_precision;
  return body;
}

struct ContactScene {
  Model model;
  std::vector<Collider> colliders;
  StepInputs inputs;
  State state;
  OpenWorkspace w;

  ContactScene(const BodyDescription& body, std::vector<Collider> all, const Vec3& place = Vec3::Zero())
      : model(build_model(body)), colliders(std::move(all)), state(rest_state(model)) {
    inputs = still_inputs(model);
    inputs.colliders = &colliders;
    inputs.collider_motions.resize(colliders.size());
    state.x.rowwise() += place.transpose();
  }
  const StepReport& step() { return supple::step(model, inputs, state, w); }
  Vec3 center() const { return state.x.colwise().mean().transpose(); }
  double fastest() const { return state.v.rowwise().norm().maxCoeff(); }
  double deepest(std::size_t collider) const {
    double deepest = 0;
    for (int v = 0; v < model.vertices; ++v) {
      const Vec3 local = inputs.collider_motions[collider].end.inverse() * Vec3(state.x.row(v));
      deepest = std::max(deepest, -colliders[collider].shape.distance(local));
    }
    return deepest;
  }
};

// Compares the gradient of the contacts that were found with differences of their energy along one direction.
inline void expect_derivative_of_contacts(const ContactScene& scene) {
  const std::vector<Contact>& found = scene.w.current.contacts;
  const Positions& x = scene.w.current.x;
  Positions gradient = Positions::Zero(scene.model.free, 3);
  const Positions direction = shaken(Positions::Zero(scene.model.free, 3), 1, 6);
  const ContactChange at = add_contacts(found, x, nullptr, direction, &gradient);
  EXPECT_NEAR(at.slope, (gradient.array() * direction.array()).sum(), 1e-12 * std::abs(at.slope));
  double best = 1e300;
  for (const double h : {1e-6, 1e-7, 1e-8}) {
    const Positions forward = x + h * direction, backward = x - h * direction;
    const double slope = add_contacts(found, forward, &backward, direction, nullptr).value / (2 * h);
    best = std::min(best, std::abs(slope - at.slope));
  }
  EXPECT_LT(best, 1e-6 * std::abs(at.slope));
}

// Lists the numbers of a matrix by free vertex one after the other, three a vertex.
inline Eigen::VectorXd stacked(const Positions& r) { return Eigen::Map<const Eigen::VectorXd>(r.data(), r.size()); }

}  // namespace supple::test
