// Provides a body among colliders, and what its steps need, for tests and studies of contact.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "geometry/tetrahedralize.h"
#include "sim/solver/step.h"
#include "support/bodies.h"

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
  Workspace w;

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

}  // namespace supple::test
