// Makes the steps of a world's bodies. The step of an island of bodies that may touch (island_finder.h) is that of one
// model, of which they are the parts (sim/model/joined_model.h), and ends in the bodies' own states and reports. A body
// that no other one may touch makes its own step. The step of an island does not depend on what its solver did in
// earlier steps, so that a film that is resumed has the same bits.
//
// A body first makes its step without contact with itself. If it began the step partly inside itself, or came through
// its own surface (sim/contact/own_surface.h, for cloth own_sheet.h), the step is made again with contact of the body
// with itself. So a body that does not touch itself pays for this test alone, and keeps its bits.
//
// Bodies that make their own steps make them at the same time, one on each thread, where that takes less time than one
// after the other with all threads inside each step. The bits are the same.
#pragma once

#include <memory>
#include <vector>

#include "geometry/triangles/moving_surface.h"
#include "world/body_touch.h"
#include "world/island_finder.h"
#include "world/joined_step.h"
#include "world/moving_body.h"
#include "world/restitution.h"

namespace supple {

struct Contact;
struct SceneDef;

class Islands {
 public:
  // All that is passed must outlive this object. bodies: those of the scene, in its order.
  Islands(const SceneDef& scene, const std::vector<std::unique_ptr<MovingBody>>& bodies, const Solvers& solvers,
          Threads* threads);
  ~Islands();

  // Returns the islands of the step that was prepared (island_finder.h), and forgets the touches of the step before.
  std::vector<std::vector<std::size_t>> find();

  // Returns the touches of the steps that were made since find(), ordered by body.
  const std::vector<BodyTouch>& touches() const { return touches_; }

  // Returns the step that several bodies, or one that touches itself, made last.
  const JoinedStep& last_step() const { return last_step_; }

  // Returns which bodies, of those that are islands of their own, should make their steps at the same time, the one
  // with most work first; empty where that would not be faster.
  std::vector<std::size_t> find_independent(const std::vector<std::vector<std::size_t>>& islands) const;
  // Makes the steps of the bodies that find_independent() returned, on all threads. Returns those whose steps are made.
  // For the others, which touch themselves or whose step failed, step() is to be called: their states have not changed.
  std::vector<std::size_t> step_at_once(const std::vector<std::size_t>& independent);
  // Returns how much time step_at_once() has saved since find(), against the same steps one after the other [ms].
  double saved_ms() const { return saved_ms_; }

  // Makes the step of an island, and lets its bodies bounce. Returns the body whose step failed, or -1; if one failed,
  // no state changes.
  int step(const std::vector<std::size_t>& island);

 private:
  struct Together;  // a joined model, with what its steps need
  struct Own;       // what a body needs to know whether it touches itself
  // Tells of each body of an island whether it touches itself.
  using Selves = std::vector<char>;

  Together& together(const std::vector<std::size_t>& island);
  int step_without_bounce(const std::vector<std::size_t>& island);
  int step_once(const std::vector<std::size_t>& island, const Selves& selves);
  int step_together(const std::vector<std::size_t>& island, const Selves& selves);
  bool step_alone(std::size_t body);
  Own& own_of(std::size_t body);
  bool begins_in_itself(std::size_t body, const Positions& q);
  bool comes_through_itself(std::size_t body, const Positions& q);
  void note_touches(const std::vector<std::size_t>& island, const Model& joined, const Positions& x,
                    const std::vector<Contact>& contacts);
  StepInputs inputs_of(const std::vector<std::size_t>& island, const Selves& selves, const Model& joined) const;

  const SceneDef& scene_;
  const std::vector<std::unique_ptr<MovingBody>>& bodies_;
  Solvers solvers_;
  Threads* threads_;
  IslandFinder finder_;
  Restitution restitution_;
  std::vector<Own> owns_;       // by body
  std::vector<double> wasted_;  // by body: time of a step in step_at_once() that must be made again [ms]
  std::vector<BodyTouch> touches_;
  double saved_ms_ = 0;
  JoinedStep last_step_;
  std::vector<std::unique_ptr<Together>> together_;  // kept for later steps, the one that was used last first
};

}  // namespace supple
