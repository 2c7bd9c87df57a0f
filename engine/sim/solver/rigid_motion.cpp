#include "sim/solver/rigid_motion.h"

#include <Eigen/Eigenvalues>

namespace supple {
namespace {

// Tells how much the vertices' velocities count in the fit of the rigid one.
class Weights {
 public:
  explicit Weights(const Model& model) : model_(model) {
    double mass = 0;
    for (int i = 0; i < model.free; ++i) mass += model.mass[i];
    constexpr double held_over_free = 1e6;  // so that the fit follows what is held, and keeps ten digits
    held_ = held_over_free * mass;
  }
  double operator()(int vertex) const {
    const bool held =
        vertex >= model_.free || (!model_.handle_stiffness.empty() && model_.handle_stiffness[vertex] > 0);
    return held ? held_ : model_.mass[vertex];
  }

 private:
  const Model& model_;
  double held_;  // the weight of a vertex that a handle holds [kg]
};

// Returns the smallest of the vectors that a symmetric matrix takes nearest to `right`. Vertices in one line do not
// turn about it, so that their inertia is singular.
Vec3 least_solution(const Mat3& matrix, const Vec3& right) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(matrix);
  const Vec3& values = solver.eigenvalues();  // in ascending order
  Vec3 solution = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (values[k] > 1e-12 * values[2])
      solution += solver.eigenvectors().col(k) * (solver.eigenvectors().col(k).dot(right) / values[k]);
  }
  return solution;
}

}  // namespace

Vec3 RigidMotion::turn_by(const Vec3& impulse, const Vec3& arm) const {
  return least_solution(inertia, arm.cross(impulse));
}

RigidMotion rigid_motion(const Model& model, const Positions& x, const Positions& v) {
  const Weights weight(model);
  RigidMotion rigid;
  for (int i = 0; i < model.vertices; ++i) {
    rigid.mass += weight(i);
    rigid.center += weight(i) * x.row(i).transpose();
    rigid.linear += weight(i) * v.row(i).transpose();
  }
  rigid.center /= rigid.mass;
  rigid.linear /= rigid.mass;
  Vec3 momentum = Vec3::Zero();
  for (int i = 0; i < model.vertices; ++i) {
    const Vec3 arm = x.row(i).transpose() - rigid.center;
    rigid.inertia += weight(i) * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    momentum += weight(i) * arm.cross(Vec3(v.row(i).transpose()));
  }
  rigid.angular = least_solution(rigid.inertia, momentum);
  return rigid;
}

}  // namespace supple
