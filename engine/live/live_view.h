// Holds the camera that a page looks through: the scene's, or the page's own.
#pragma once

#include <optional>

#include "render/draw_list.h"

namespace supple {

class LiveView {
 public:
  // Turns the eye about the target. degrees: of azimuth and elevation. These three make the view the page's own,
  // beginning with the camera that was seen last.
  void orbit(const Eigen::Vector2d& degrees);
  // Moves what is seen to the right and up, by shares of the picture's height at the target's distance.
  void pan(const Eigen::Vector2d& shares);
  // Brings the eye nearer to the target. factor: above 1 is nearer.
  void zoom(double factor);
  // Looks through the scene's camera again.
  void home() { own_.reset(); }
  bool is_own() const { return own_.has_value(); }

  // Returns the camera for a list. A view of the page's own goes along with what the scene's camera follows.
  Camera see(const DrawList& list);
  // Returns the camera that see() returned last.
  const Camera& seen() const { return seen_; }

 private:
  Camera& own();

  Camera seen_;
  Vec3 moved_ = Vec3::Zero();  // how far what is followed had moved since the start when seen_ was made [m]
  std::optional<Camera> own_;  // as it was when moved_ was noted
};

}  // namespace supple
