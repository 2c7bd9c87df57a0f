// Offers bodies made of arrays to Python: a model, its states, colliders, and the step.
#pragma once

#include <memory>
#include <vector>

#include "guard.h"
#include "scene/building/collision_set.h"
#include "sim/sim.h"
#include "values.h"

namespace supple::python {

// Holds rigid obstacles, each described as a scene's [[collider]] is.
struct CollidersFace {
  CollisionSet set;
  explicit CollidersFace(const py::list& tables);
};

struct ModelFace {
  Model model;
  std::vector<std::int32_t> pinned;  // vertices of the mesh, in the order of targets
  Positions rest;                    // n x 3 in the order of the mesh [m]

  // material: what a scene's body has there; pins: vertices that are held; pin_stiffness: of their springs [N/m], or
  // None where they are held exactly. solver: keys of the table [solver].
  ModelFace(const py::object& vertices, const py::object& tetrahedra, const py::object& material,
            const py::object& density, double time_step, const py::object& pins, const py::object& pin_stiffness,
            const py::dict& solver);

  SolverSettings settings;
};

// Holds a state of a model, with the memory in which its steps are made.
class StateFace {
 public:
  explicit StateFace(std::shared_ptr<const ModelFace> model, int threads);
  ~StateFace();

  py::array positions() const { return view_of(x_, true); }
  py::array velocities() const { return view_of(v_, true); }
  double time() const { return held_->state.time; }

  // Makes a step. targets: the places of the pinned vertices at its end; None: their places at rest.
  py::dict step(const ModelFace& model, const py::object& gravity, const CollidersFace* colliders,
                const py::object& targets);

 private:
  struct Held {
    Threads threads;
    Workspace workspace;
    State state;
    explicit Held(int thread_count) : threads(thread_count), workspace(&threads) {}
  };
  Busy busy_;
  pid_t process_ = getpid();
  std::shared_ptr<const ModelFace> model_;
  std::unique_ptr<Held> held_;
  std::shared_ptr<Positions> x_, v_;  // n x 3 in the order of the mesh; what Python sees and may write
};

}  // namespace supple::python
