// Makes the draw lists of a run's frames, and of moments between them, from the motion that the run has saved.
#pragma once

#include <vector>

#include "film/pictures/drawn_film.h"
#include "film/redraw/redraw.h"

namespace supple {

class RunLists {
 public:
  // The drawing must outlive this object.
  explicit RunLists(LoadedDrawing& drawing);

  const Stage& stage() const { return drawn_.stage(); }
  DrawnFilm& drawn() { return drawn_; }

  // Returns the list of a moment. Moments must be asked for in ascending order.
  DrawList list(const Moment& moment);

 private:
  void span_film(bool field, bool camera);
  void rewind();
  Positions saved_at(std::size_t body, int frame);
  Positions motion_at(std::size_t body, const Moment& moment);
  void load(const Moment& moment);
  FramePose pose(const Moment& moment) const;
  void enter(int frame);
  const SceneDef& scene() const { return world_.scene(); }
  double picture_step() const;

  LoadedDrawing& drawing_;
  World& world_;  // its positions come from the files of the run
  DrawnFilm drawn_;
  Threads threads_;
  std::vector<Positions> motion_, before_;  // at the moment that was loaded, and a frame or a picture before it [m]
  std::vector<Positions> forces_;           // of contact, where they are needed [N]
  std::vector<GraphPoint> graphed_;         // points of all frames
};

}  // namespace supple
