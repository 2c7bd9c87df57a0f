// Provides films of a cube and a rigid body that meet, seen from different frames of reference, for tests and studies.
#pragma once

#include <algorithm>

#include "sim/measures/energies.h"
#include "sim/measures/measures.h"
#include "support/contact_scene.h"

namespace supple::test {

// Collects what a film showed of its body. Energies are relative to a frame of reference, elastic and kinetic together.
struct FilmMeasures {
  double energy = 0, end_energy = 0;    // the largest of all frames, and that of the last one [J]
  double stretch = 1, end_stretch = 1;  // the same of the largest stretch
  int inverted = 0, end_inverted = 0;   // elements
  double deepest = 0;                   // vertex at the end of a frame, over the body's size
  bool failed = false;

  void add(ContactScene& scene, const Vec3& reference_velocity) {
    State seen = scene.state;
    seen.v.rowwise() -= reference_velocity.transpose();
    const Energies all = energies(scene.model, seen, Vec3::Zero(), scene.w);
    const Deformation shape = deformation(scene.model, scene.state.x);
    end_energy = all.kinetic + all.elastic;
    end_stretch = shape.stretch;
    end_inverted = shape.inverted;
    energy = std::max(energy, end_energy);
    stretch = std::max(stretch, end_stretch);
    inverted = std::max(inverted, end_inverted);
    for (std::size_t c = 0; c < scene.colliders.size(); ++c)
      deepest = std::max(deepest, scene.deepest(c) / scene.model.size);
  }
};

// A cube of 5 x 5 x 5 vertices and a box of 0.2 x 1 x 1 m meet head on at a speed; one of them is at rest.
enum class Flies { cube, box };
inline FilmMeasures film_of_impact(const Material& material, double density, double speed, Flies flies,
                                   int substeps = 1) {
  BodyDescription body = cube(4, material);
  body.density = density;
  body.time_step = 1.0 / (30 * substeps);
  ContactScene scene(body, {{"box", shape_of(Box{Vec3(0.1, 0.5, 0.5), 0})}});
  scene.inputs.gravity.setZero();
  const Vec3 velocity = flies == Flies::box ? Vec3(speed, 0, 0) : Vec3::Zero();  // of the box
  if (flies == Flies::cube) scene.state.v.col(0).setConstant(-speed);
  Vec3 place(-0.25, 0, 0);
  FilmMeasures film;
  for (int frame = 0; frame < 30 && !film.failed; ++frame) {
    for (int substep = 0; substep < substeps && !film.failed; ++substep) {
      const Vec3 next = place + body.time_step * velocity;
      scene.inputs.collider_motions[0] = {moved_to(place), moved_to(next)};
      place = next;
      film.failed = scene.step().failed;
    }
    if (!film.failed) film.add(scene, velocity);
  }
  return film;
}

// A plate of 0.05 x 0.6 x 0.6 m turns about its middle and hits a cube at rest, whose centre is 0.2 m from the axis.
inline FilmMeasures film_of_paddle(const Material& material, double density, double turns_a_second, int substeps = 1) {
  BodyDescription body = cube(4, material);
  body.density = density;
  body.time_step = 1.0 / (30 * substeps);
  ContactScene scene(body, {{"paddle", shape_of(Box{Vec3(0.025, 0.3, 0.3), 0})}}, Vec3(0, 0, 0.2));
  scene.inputs.gravity.setZero();
  const double a_step = 2 * 3.14159265358979 * turns_a_second * body.time_step;
  double angle = -1.4;
  FilmMeasures film;
  for (int frame = 0; frame < 30 && !film.failed; ++frame) {
    for (int substep = 0; substep < substeps && !film.failed; ++substep) {
      ColliderMotion& motion = scene.inputs.collider_motions[0];
      motion.start = Eigen::AngleAxisd(angle, Vec3::UnitY());
      motion.end = Eigen::AngleAxisd(angle += a_step, Vec3::UnitY());
      film.failed = scene.step().failed;
    }
    if (!film.failed) film.add(scene, Vec3::Zero());
  }
  return film;
}

// A handle holds one face of the cube, and turns by an angle in a frame about the face's middle, five times. Then it
// is still.
inline FilmMeasures film_of_handle(const Material& material, double density, double radians_a_frame, int substeps = 1) {
  BodyDescription body = cube(4, material);
  body.density = density;
  body.time_step = 1.0 / (30 * substeps);
  Handle face{"face", {}};
  for (std::int32_t v = 0; v < body.mesh.rest.rows(); ++v) {
    if (body.mesh.rest(v, 2) < -0.1 + 1e-9) face.vertices.push_back(v);
  }
  body.handles.push_back(face);
  ContactScene scene(body, {});
  scene.inputs.gravity.setZero();
  const Positions rest = scene.inputs.targets;
  FilmMeasures film;
  for (int frame = 0; frame < 30 && !film.failed; ++frame) {
    for (int substep = 0; substep < substeps && !film.failed; ++substep) {
      const double frames = std::min(5.0, frame + (substep + 1.0) / substeps);
      const Mat3 turn = Eigen::AngleAxisd(frames * radians_a_frame, Vec3::UnitY()).toRotationMatrix();
      const Eigen::RowVector3d middle(0, 0, -0.1);
      scene.inputs.targets = ((rest.rowwise() - middle) * turn.transpose()).rowwise() + middle;
      film.failed = scene.step().failed;
    }
    if (!film.failed) film.add(scene, Vec3::Zero());
  }
  return film;
}

}  // namespace supple::test
