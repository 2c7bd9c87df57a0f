// Holds the drawn part of a film: the skins of bodies and colliders, which are made when the film starts, and the draw
// list of each frame.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "film/pictures/camera.h"
#include "film/pictures/drawn_supports.h"
#include "film/pictures/film_stage.h"
#include "film/pictures/surface_field.h"
#include "scene/replay/script.h"

namespace supple {

class DrawnFilm {
 public:
  // The script tells all cameras of the film, to which the skins' resolution is fitted. The bodies must outlive the
  // film. drawn: the drawn mesh of each body.
  DrawnFilm(const Script& script, const std::vector<Body>& bodies, std::vector<DrawnBody> drawn,
            const CollisionSet& set, const Font& font);

  const Stage& stage() const { return stage_; }

  // Makes the skins of the colliders again whose shapes these changes of a replay have changed.
  void follow(const std::vector<TimedChange>& changes, const CollisionSet& set, const std::vector<Body>& bodies);

  // Makes the draw list of a frame: positions, and all that has changed since the last list. pose: the positions with
  // the digits that the files in motion/ keep.
  DrawList list(const SceneDef& scene, const FramePose& pose, const CollisionSet& set, Threads& threads);

  // Returns the share of a body's surface that lies within the borders of a frame's picture.
  double share_in_picture(std::size_t body, const DrawList& list) const {
    return supple::share_in_picture(list.camera, stage_, list.positions[body]);
  }
  // Returns how far a body's skin is stretched beyond its elements in a list (film_stage.h). now: the positions of its
  // mesh [m].
  std::optional<double> skin_excess_of(std::size_t body, const DrawList& list, const TetMesh& mesh,
                                       const Positions& now) const {
    return skin_excess(drawn_[body], list.positions[body], mesh, now);
  }

  // Tells whether a pose must have the positions of the frame before.
  bool needs_before() const { return opens_ || (field_ && field_->needs_before()); }
  // Widens the range of the field to a frame of the film. The colours are those of the whole film once all frames have
  // been included and settle_field() has been called, which must happen before the stage is used.
  void include_in_field(const FramePose& pose, const CollisionSet& set, Threads& threads);
  void settle_field();
  // Returns the colours and the legend of the field, where there is one.
  std::optional<FieldLook> field_look() const { return field_ ? std::optional(field_->look()) : std::nullopt; }
  // Returns the range of the field, which the scene must have.
  Eigen::Vector2d field_range() const { return field_->range(); }
  // Takes the legend off the pictures; the caller shows it. Must be called before the stage is used.
  void hide_legend();
  // Makes cameras frame these outermost points of the bodies' motion over the whole film [m]. Must be called before the
  // stage is used.
  void frame_motion(std::vector<Vec3> motion);
  // Gives the graph of times its scale, from all rows of the film. Must be called before the stage is used.
  void know_times(std::span<const FrameRow> rows);

 private:
  std::vector<std::vector<float>> positions(const SceneDef& scene, const FramePose& pose, const CollisionSet& set,
                                            Threads& threads);
  std::optional<Exposure> exposure(const SceneDef& scene, const FramePose& pose, const CollisionSet& set,
                                   const DrawList& list, Threads& threads);
  void show_field();
  void make_room();
  void add_ghosts(const SceneDef& scene, const std::vector<Body>& bodies);
  void follow_colors(const SceneDef& scene, DrawList& list);

  const std::vector<Body>& bodies_;
  SceneDef start_;               // the scene at the start of the film
  std::vector<Camera> cameras_;  // over the film, to which skins are fitted
  std::vector<DrawnBody> drawn_;
  std::vector<Skin> collider_skins_;
  std::optional<DrawnSupports> supports_;  // where the scene shows them
  std::optional<ReferenceRun> ghosts_;     // the run whose bodies are the stage's last meshes
  std::optional<SurfaceField> field_;      // where the scene shows one
  bool opens_ = false;                     // whether the shutter is open for more than an instant in some frame
  Stage stage_;
  double longest_steps_ = 0;          // the longest time of a frame's steps in the film [ms]; 0: not known
  std::vector<std::size_t> renewed_;  // colliders whose skins were made again since the last list
};

}  // namespace supple
