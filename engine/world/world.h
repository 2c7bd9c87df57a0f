// Represents a scene in time. A world owns its bodies, their models and states, the colliders, and the motions that
// drive them from outside; it applies a replay's changes, makes the steps, and is saved and restored. Films, redrawn
// films, stored states, benchmarks, estimates of cost and other programs all move a scene here, so that they agree to
// the last bit.
//
//   World world(Script::load(...), assemble(...));
//   world.start(solvers, &threads);
//   for (int frame = 0; frame < world.scene().frames; ++frame) {
//     world.enter(frame);
//     if (!world.step()) break;
//   }
//
// In each substep, bodies that may touch each other make their step together (islands.h); each of the others makes its
// own step, several at the same time where that is faster.
//
// Not here: what is recorded of a world, and what is drawn of it (film/).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "scene/replay/script.h"
#include "world/body_touch.h"
#include "world/joined_step.h"
#include "world/moving_body.h"
#include "world/world_state.h"

namespace supple {

// Looks at a world while it makes the steps of a frame. All functions may be empty. The first two are called for each
// step of each body, with the number of the body and that of the substep.
struct StepWatch {
  std::function<void(std::size_t body, int substep)> prepared;  // the inputs are known, the step is not made
  std::function<void(std::size_t body, int substep)> made;      // the step was made, or has failed
  std::function<bool()> stops = {};  // asked before each substep but a call's first; true: the frame is left unfinished
};

class World {
 public:
  // Takes the bodies of a scene as they are assembled (scene/building/assemble.h).
  World(Script script, std::vector<Body> bodies);
  // Takes the bodies of a scene without changes; script() must then not be called.
  World(SceneDef scene, std::vector<Body> bodies);
  World(World&&) noexcept;
  ~World();

  const Script& script() const;
  const SceneDef& scene() const;  // the scene at the end of the frame that was entered last
  const std::vector<Body>& bodies() const;
  const CollisionSet& colliders() const;

  // Lets a body start where it was in an earlier run. To be called before start().
  void begin_from(std::size_t body, EarlierState state);

  // Builds the models of all bodies, unless they are there. Throws RunError and InputError as build_model does. A world
  // whose positions come from a file needs no models and is not started.
  void build_models();
  // Puts all bodies to the start of the film, with these solvers. threads: null for the calling thread alone; they must
  // outlive the world.
  void start(const Solvers& solvers, Threads* threads);

  // Begins a frame: applies the changes of this frame and of all between it and the one that was entered last, and
  // returns them. In a scene without changes, an earlier frame can be entered too.
  std::vector<TimedChange> enter(int frame);
  // Goes back to the scene before its first frame. The states stay.
  void rewind();

  // Makes all steps of the frame that was entered, or those that are left of one that the watch stopped. Returns false
  // as soon as a step has failed, whose report then says why, or when the watch stops the frame. The states are then in
  // the middle of the frame.
  bool step(const StepWatch& watch = {});
  // Enters a frame and makes its steps.
  bool play(int frame, const StepWatch& watch = {}) {
    enter(frame);
    return step(watch);
  }
  // Returns the number of frames that were entered, the present one among them.
  int frames() const;
  // Tells whether a step has led to the present state, so that reports and contacts are those of this state: false
  // before the first step and after restore().
  bool has_stepped() const;
  // Tells whether the steps of the frame that was entered last were begun and not finished, because the watch stopped
  // them or one failed.
  bool is_within_frame() const;

  // These three act from the next frame on, as a replay that changes values and grabs vertices would: Script keeps what
  // was done, and writes it as a replay. They must not be called within a frame. They throw InputError with all that is
  // wrong, and then change nothing.
  //
  // Changes a value; `at` of the change is ignored.
  void change(TimedChange change);
  // Makes a handle that holds vertices where they are, with springs; `from` and `until` of the grab are ignored. A
  // change of body.BODY.handles.NAME.keys moves it.
  void grab(LiveGrab grab);
  // Lets the vertices go that grab() holds. Throws InputError where no handle of this name holds any.
  void release(const std::string& body, const std::string& handle);

  // Computes the inputs of one substep of the frame that was entered, for those who make the step themselves. Changes
  // no result.
  void prepare(int substep);

  // The functions from here to body() are for worlds that were started.
  //
  // Returns how bodies touched each other and themselves at the end of the step that was made last, ordered by body.
  const std::vector<BodyTouch>& touches() const;
  // Returns the step of a joined model (islands.h) that was made last. Where MovingBody::is_in_island() holds for a
  // body whose step was just made, it is the step of that body.
  const JoinedStep& joined_step() const;

  // Returns how much time the steps of the last frame saved, against the sum of their own times, because bodies made
  // them at the same time [ms].
  double saved_ms() const;

  std::size_t size() const;  // number of bodies
  // Returns the number of a body. Throws InputError, which lists the bodies, where there is none of this name.
  std::size_t body_named(const std::string& name) const;
  // Returns a body: its state().x has positions in the order of its model(), which in_input_order() puts into that of
  // the mesh in bodies().
  MovingBody& body(std::size_t index);
  const MovingBody& body(std::size_t index) const;

  // Returns the state after the frame that was entered last, or before the first frame. A copy is a snapshot.
  WorldState state() const;
  // Returns to a state of this film, earlier or later: also to the scene at that time.
  void restore(const WorldState& state);
  // Returns the hash of the state: of a single body, its state_hash(); of several, the XXH64 of their hashes in the
  // order of the scene.
  std::uint64_t hash() const;

 private:
  struct Parts;  // on the heap, so that they stay in place when the world is moved
  std::unique_ptr<Parts> parts_;
};

}  // namespace supple
