// A soft cube falls on the ground. Prints a frame's number and the height of the lowest vertex [m].
#include <sim/sim.h>

#include <cstdio>

int main() {
  using namespace supple;

  BodyDescription cube;
  cube.name = "cube";
  cube.mesh = box_mesh(Vec3(0.2, 0.2, 0.2), Eigen::Vector3i(4, 4, 4));
  transform(cube.mesh, 1, Vec3(0, 0.5, 0));  // not scaled; the mesh begins at the origin, so its bottom is at y = 0.5
  cube.materials = {NeoHookean::from(Lame::from_young(1e5, 0.4))};

  Collider ground;
  ground.name = "ground";
  ground.shape.root.parts = {ShapePart{HalfSpace{Vec3(0, 1, 0), 0}}};  // a tree of one part, solid below y = 0
  const std::vector<Collider> colliders = {ground};

  StepInputs inputs;
  inputs.colliders = &colliders;
  inputs.collider_motions.resize(colliders.size());  // it stays where it is

  const Model model = build_model(cube);
  State state = rest_state(model);
  Workspace workspace;
  for (int frame = 0; frame <= 60; ++frame) {  // a step is cube.time_step = 1/30 s
    std::printf("%d %.4f\n", frame, state.x.col(1).minCoeff());
    const StepReport& report = step(model, inputs, state, workspace);
    if (!report.failed) continue;
    std::fprintf(stderr, "frame %d: %s: %s\n", frame, report.failure.during.c_str(), report.failure.what.c_str());
    return 1;
  }
}
