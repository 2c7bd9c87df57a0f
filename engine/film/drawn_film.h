// Holds the drawn part of a film: the skins of bodies and colliders, which are made when the film starts, and the draw
// list of each frame.
#pragma once

#include <string>
#include <vector>

#include "film/draw_scene.h"
#include "scene/script.h"

namespace supple {

class DrawnFilm {
 public:
  // The script tells all cameras of the film, to which the skins' resolution is fitted. drawn: of each body.
  DrawnFilm(const Script& script, const std::vector<Body>& bodies, std::vector<DrawnBody> drawn,
            const CollisionSet& set, const std::string& font);

  const Stage& stage() const { return stage_; }

  // Makes the skins of colliders again when these changes of a replay have changed their shapes.
  void follow(const std::vector<TimedChange>& changes, const CollisionSet& set, const std::vector<Body>& bodies);

  // Makes the draw list of a frame: positions, and all that has changed since the last list. motion: for each body, the
  // positions of its mesh as motion/ holds them [m]. time: the end of the frame [s].
  DrawList list(const SceneDef& scene, const std::vector<const Positions*>& motion, const CollisionSet& set,
                double time, Threads& threads);

 private:
  std::vector<DrawnBody> drawn_;
  std::vector<Skin> collider_skins_;
  Stage stage_;
  std::vector<std::size_t> renewed_;  // colliders, since the last list
};

}  // namespace supple
