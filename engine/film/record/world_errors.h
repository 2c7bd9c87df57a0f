// Measures the errors of a world's steps where a film asks for them, against converged solutions. It looks at the steps
// that a world makes and changes none of them. A step that several bodies made together is measured once, for all of
// them. Not here: which steps are measured, and what becomes of the numbers (body_recorder.h).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "film/plan/film_solvers.h"
#include "world/world.h"

namespace supple {

class WorldErrors {
 public:
  // All that is passed must outlive this object. The world must have been started when a step is measured.
  WorldErrors(World& world, const FilmSolvers& solvers, Threads& threads)
      : world_(world), solvers_(solvers), threads_(threads), bodies_(world.size()) {}

  // Keeps the state of a body from which a step to be measured begins.
  void before_step(std::size_t body) { bodies_[body].before = world_.body(body).state(); }

  // Returns the errors of a body's step, which was just made and has not failed; nothing where the step was made with
  // another energy, which has another minimum (MovingBody::untangled). For a step of several bodies this must be called
  // for each of them, in the order of the scene, before the next step is made.
  std::optional<MeasuredErrors> of_step(std::size_t body);

 private:
  struct OfBody {
    State before;
    std::unique_ptr<ErrorMeter> meter;    // of steps that the body makes by itself; made when first asked for
    std::uint64_t metered_model = 0;      // id of the model's values for which the meter is valid
    std::optional<MeasuredErrors> found;  // of the step of an island, until they are asked for
  };

  void measure_alone(std::size_t body);
  void measure_joined(const JoinedStep& step);

  World& world_;
  const FilmSolvers& solvers_;
  Threads& threads_;
  std::vector<OfBody> bodies_;
};

}  // namespace supple
