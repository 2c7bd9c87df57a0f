#include "film/redraw/run_lists.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/interrupts.h"
#include "base/motion_hull.h"
#include "film/plan/shipped_files.h"
#include "film/redraw/smooth_motion.h"
#include "output/files/obj_file.h"
#include "output/run/run_record.h"

namespace supple {

RunLists::RunLists(LoadedDrawing& drawing)
    : drawing_(drawing),
      world_(drawing.film.world),
      drawn_(world_.script(), world_.bodies(), drawing.film.drawn, world_.colliders(),
             text_font(world_.script().scene().text)),
      threads_(drawing.film.info.threads) {
  drawn_.know_times(drawing.rows);
  for (const FrameRow& row : drawing.rows) graphed_.push_back(graph_point(row));
  const bool field = scene().field.quantity != FieldQuantity::none && scene().field.range_by == FieldRange::film;
  const std::vector<Vec3>& framed = drawing.film.info.framed;
  const bool finds = framed.empty() && wants_motion(scene());
  const bool shows = wants_motion(scene()) || scene().camera.frames == Framed::automatic;
  if (!framed.empty() && shows) drawn_.frame_motion(framed);
  if (field || finds) span_film(field, finds);
}

DrawList RunLists::list(const Moment& moment) {
  enter(moment.frame);
  load(moment);
  return drawn_.list(scene(), pose(moment), world_.colliders(), threads_);
}

// Finds the range of the field and the box of the motion over all frames of the run, so that each picture has the same
// colours and the same camera, whichever frames are drawn and in how many parts.
void RunLists::span_film(bool field, bool camera) {
  MotionHull hull;
  for (int frame = 0; frame < drawing_.frame_count && !interrupted(); ++frame) {
    enter(frame);
    load({frame, 0});
    if (field) drawn_.include_in_field(pose({frame, 0}), world_.colliders(), threads_);
    for (const Positions& body : motion_) hull.include(body);
  }
  if (field) drawn_.settle_field();
  if (camera) drawn_.frame_motion(hull.points());
  rewind();
}

// Goes back to the start of the film.
void RunLists::rewind() {
  world_.rewind();
  drawn_.follow(world_.script().changes(), world_.colliders(), world_.bodies());
}

// Returns what the run saved of a frame; before the first one, the start of the film.
Positions RunLists::saved_at(std::size_t body, int frame) {
  if (frame >= 0) return saved_positions(drawing_, body, std::min(frame, drawing_.frame_count - 1));
  const Vec3 origin = motion_origin(world_.bodies()[body].description.mesh.rest);
  const std::optional<EarlierFrame>& from = scene().from;
  if (const auto file = from ? RunRecord{from->run, {}, {}}.motion(world_.bodies()[body].def.name) : "";
      !file.empty() && std::filesystem::exists(file))
    return PointCacheReader(file).frame(from->frame).rowwise() + origin.transpose();
  const Positions first = first_positions(world_.bodies()[body]).rowwise() - origin.transpose();
  return as_cached(first).rowwise() + origin.transpose();
}

Positions RunLists::motion_at(std::size_t body, const Moment& moment) {
  if (moment.share == 0) return saved_at(body, moment.frame);
  std::array<Positions, 4> frames;
  for (int k = 0; k < 4; ++k) frames[std::size_t(k)] = saved_at(body, std::max(-1, moment.frame - 1 + k));
  return between_frames(frames, moment.share);
}

// Returns how far the moment of `before_` is before that of a picture [frames of the run]: in slow motion the step from
// one picture to the next, so that pictures are blurred as by a camera that takes as many of them; otherwise one frame.
double RunLists::picture_step() const {
  const Moment first = moment_of(drawing_, 0), second = moment_of(drawing_, 1);
  return drawing_.smooth > 1 ? second.frame - first.frame + second.share - first.share : 1;
}

void RunLists::load(const Moment& moment) {
  motion_.clear();
  before_.clear();
  forces_.clear();
  const double earlier = std::max(-1.0, moment.frame + moment.share - picture_step());
  const Moment before = {static_cast<int>(std::floor(earlier)), earlier - std::floor(earlier)};
  for (std::size_t b = 0; b < drawing_.motion.size(); ++b) {
    motion_.push_back(motion_at(b, moment));
    if (drawn_.needs_before()) before_.push_back(motion_at(b, before));
  }
  const int next = std::min(moment.frame + 1, drawing_.frame_count - 1);
  for (ForceFileReader& body : drawing_.forces) {
    forces_.push_back(body.frame(moment.frame));
    if (moment.share > 0) forces_.back() += moment.share * (body.frame(next) - forces_.back());
  }
}

FramePose RunLists::pose(const Moment& moment) const {
  const int frame = moment.frame;
  FramePose pose{frame, scene().time_after(frame), {}, {}};
  if (moment.share > 0) pose.time += moment.share / scene().fps;
  if (drawing_.smooth > 1) pose.interval = picture_step() / scene().fps;
  for (const Positions& body : motion_) pose.motion.push_back(&body);
  for (const Positions& body : before_) pose.before.push_back(&body);
  for (const Positions& body : forces_) pose.forces.push_back(&body);
  const std::vector<FrameRow>& rows = drawing_.rows;
  pose.earlier = std::span(graphed_).first(std::min(graphed_.size(), std::size_t(frame)));
  if (std::size_t(frame) < rows.size()) pose.row = &rows[std::size_t(frame)];
  return pose;
}

// Advances the world to the end of the frame.
void RunLists::enter(int frame) {
  const std::vector<TimedChange> changes = world_.enter(frame);
  if (!changes.empty()) drawn_.follow(changes, world_.colliders(), world_.bodies());
}

}  // namespace supple
