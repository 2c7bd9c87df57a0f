#include "sim/solver/calming.h"

#include "sim/solver/rigid_motion.h"

namespace supple {

void calm(const Model& model, double kept, const Positions& x, Positions& v) {
  const RigidMotion rigid = rigid_motion(model, x, v);
  for (int i = 0; i < model.free; ++i) {
    const Vec3 whole = rigid.at(x.row(i).transpose());
    v.row(i) = (whole + kept * (v.row(i).transpose() - whole)).transpose();
  }
}

}  // namespace supple
