// Plays scenes of bodies that meet, frame by frame, and computes the sums over bodies by which the section `touching`
// judges them.
#pragma once

#include <string>
#include <vector>

#include "app/bench/bench.h"
#include "sim/solver/open_workspace.h"
#include "world/world.h"

namespace supple {

// Holds what the steps of one frame took.
struct TouchingWork {
  double ms = 0;                    // wall time, with finding which bodies may touch each other
  int iterations = 0, trials = 0;   // steps that bodies make together count once
  int contacts = 0;                 // points that touch another body, at the frame's end
  int collider_contacts = 0;        // points that touch colliders
  std::vector<double> depths = {};  // of each pair of bodies that touch, over the smaller one's size
  std::size_t largest_island = 1;   // bodies that made their last step together, at most
};

class TouchingFilm {
 public:
  // Puts a world to its start, with the scene's own solver. threads: they must outlive this object.
  TouchingFilm(const SceneDef& scene, std::vector<Body> bodies, Threads& threads);
  // Does the same with the text of a scene.
  TouchingFilm(const std::string& text, Threads& threads);

  // Plays the next frame. Returns false when a step has failed. Throws BenchInterrupted.
  bool play(const StepWatch& watch = {});
  // Plays frames until so many are made. Returns false when a step has failed.
  bool play_until(int frames);

  World& world() { return world_; }
  int frames() const { return frames_; }              // that were played
  double time() const;                                // after them [s]
  const TouchingWork& work() const { return work_; }  // of the last frame
  double size(std::size_t body) const { return world_.body(body).model().size; }

  // Returns the positions of a body's vertices, in the order of its mesh [m].
  Positions places(std::size_t body) const;
  Vec3 center(std::size_t body) const;    // of the mass that is free to move [m]
  Vec3 momentum(std::size_t body) const;  // [kg m/s]
  Vec3 velocity(std::size_t body) const;  // of the centre of mass [m/s]
  Vec3 momentum() const;                  // of all bodies [kg m/s]
  Vec3 angular_momentum() const;          // of all bodies, about the origin [kg m^2/s]
  double kinetic_energy() const;          // of all bodies [J]
  double energy();                        // kinetic and elastic, of all bodies [J]

 private:
  World world_;
  OpenWorkspace scratch_;
  TouchingWork work_;
  int frames_ = 0;
};

// Returns the text of the ground, with a coefficient of friction.
std::string ground_text(double friction);

// Returns the value that this share of the values does not exceed, by the nearest rank; NaN where there are none.
double rank_of(std::vector<double> values, double share);

}  // namespace supple
