// Computes the field that surfaces show in colours: which value each vertex of a body has, and what range the colours
// span. Everything follows from the scene and from the positions and forces that a run keeps, so that a film has the
// same colours when it is drawn again. Not here: the formulas of elements (sim/measures/pose_elements.h), and how
// colours are drawn (render/).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/threads.h"
#include "film/pictures/film_graphs.h"
#include "film/pictures/reference_run.h"
#include "output/run/profile.h"
#include "render/draw_list.h"
#include "scene/building/collision_set.h"
#include "scene/building/drawn_body.h"
#include "scene/definition/field_def.h"
#include "sim/measures/pose_elements.h"

namespace supple {

struct SceneDef;

// Describes the bodies at the end of a frame, and at the end of the frame before.
struct FramePose {
  int frame = 0;
  double time = 0;  // at the end of the frame [s]
  // These lists have one entry for each body, by vertex of its mesh [m]. `before` is of the frame before; it is empty
  // where neither the field nor the shutter needs it.
  std::vector<const Positions*> motion, before;
  // The forces of contact at the end of the frame: for each body, by vertex of its mesh [N]. Empty where the field does
  // not need them; without rows, or zero, where the scene has nothing to touch.
  std::vector<const Positions*> forces = {};
  const FrameRow* row = nullptr;             // row of the frame in the run's profile; null where it is not known
  std::span<const GraphPoint> earlier = {};  // points of all earlier frames; empty where the pictures have no graphs
  std::optional<double> interval = {};       // since the positions of `before`; nothing: that of a frame [s]
};

class SurfaceField {
 public:
  // The bodies must outlive the field. Throws InputError when no body has the quantity, and when the reference run does
  // not have the bodies' motion.
  SurfaceField(const SceneDef& scene, const std::vector<Body>& bodies);

  bool needs_before() const { return def_.quantity == FieldQuantity::speed; }
  bool needs_forces() const { return def_.quantity == FieldQuantity::force; }
  // Tells whether a body has the quantity; others keep their own colours.
  bool shown_on(std::size_t body) const { return shown_[body]; }

  // Returns the value of each vertex of each body's mesh; empty for bodies that do not have the quantity. Throws
  // InputError when the reference run does not have the frame.
  std::vector<std::vector<double>> values(const FramePose& pose, const CollisionSet& set, Threads* threads);

  // Widens the range of the whole film for the values of one frame: only a hundredth of the vertices may lie above it
  // (for contact forces, a hundredth of the vertices with a force). The range begins at the value at rest, or has it in
  // the middle.
  void include(const std::vector<std::vector<double>>& values);
  // Ends the search for the range of the whole film: rounds it to a number that reads well.
  void settle();

  // Returns the values of a skin's vertices, over the range: 0 at its low end, 1 at its high one.
  std::vector<float> on_skin(const DrawnBody& drawn, const std::vector<double>& values) const;

  FieldLook look() const;
  Eigen::Vector2d range() const { return range_; }

 private:
  std::vector<double> of_body(std::size_t body, const FramePose& pose, const CollisionSet& set, Threads* threads);

  FieldDef def_;
  double fps_;
  const std::vector<Body>& bodies_;
  std::vector<bool> shown_;
  std::vector<std::optional<PoseElements>> elements_;  // by body: elements of solids, for quantities of elements
  std::vector<std::vector<double>> areas_;             // of the surface at rest, by vertex, for forces [m^2]
  std::optional<ReferenceRun> reference_;              // the run to which distances are measured
  Eigen::Vector2d range_ = Eigen::Vector2d(0, 1);
  double furthest_ = 0;  // the furthest from the value at rest, in all frames that were included
};

// Returns the places of a legend's numbers between low and high, from 0 to 1, and the numbers. `scale` multiplies them.
std::vector<std::pair<double, std::string>> ticks_between(double low, double high, double scale);

// Returns the smallest of 1, 2 and 5 times a power of ten that is not below a positive value.
double rounded_up(double value);

}  // namespace supple
