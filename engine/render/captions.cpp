#include "render/captions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "render/caption.h"
#include "render/legend.h"
#include "render/projection.h"

namespace supple {
namespace {

constexpr double note_size = 0.8;  // of a note's letters, over those of the caption

bool same(const Camera& a, const Camera& b) { return a.eye == b.eye && a.target == b.target && a.fov_deg == b.fov_deg; }

}  // namespace

Captions::Captions(const Stage& stage, std::vector<PixelRect> taken)
    : font_(stage.font),
      note_template_(stage.note_template),
      width_(stage.width),
      height_(stage.height),
      ink_(ink_on(stage)),
      around_(framed_at_start(stage)),
      taken_(std::move(taken)) {
  if (stage.camera_moves) first_camera_ = stage.first_camera;
  for (const DrawMesh& mesh : stage.meshes) bodies_.push_back({mesh.label, mesh.rest, mesh.kept_clear, mesh.board});
}

void Captions::renew(std::size_t mesh, const std::string& label) {
  bodies_[mesh].label = label;
  camera_.reset();
}

int Captions::width_of(const std::string& text, int em) const {
  return text.empty() ? 0 : draw_caption(font_, text, em).width;
}

// Returns the pixel below which a body's caption stands; nothing behind the eye. The caption stands on the ground: for
// a body that hangs in the air, below the place where it starts. z: of the part below which it stands [m].
std::optional<Eigen::Vector2d> Captions::foot_of(const Projection& project, const Body& body, double z) const {
  std::optional<Eigen::Vector2d> foot = project({body.rest.center().x(), std::min(body.rest.lower.y(), 0.0), z});
  if (!foot || !body.kept_clear) return foot;
  for (const Eigen::Vector2d& corner : project.outline(body.rest)) foot->y() = std::max(foot->y(), corner.y());
  return foot;
}

namespace {

// Returns the smallest box that is parallel to the picture's edges and holds outlines.
Eigen::AlignedBox2d box_of(const std::vector<Outline>& outlines) {
  Eigen::AlignedBox2d box;
  for (const Outline& outline : outlines) {
    for (const Eigen::Vector2d& corner : outline) box.extend(corner);
  }
  return box;
}

}  // namespace

// Returns the place beside a body and its board; nothing where it has none, or where the board is as large as a floor,
// which the picture does not show to its end.
std::optional<Captions::Anchor> Captions::beside_board(const Projection& project, const Body& body) const {
  if (!body.board) return std::nullopt;
  const Vec3 middle = body.rest.center(), ahead = middle + 0.5 * body.rest.diagonal() * body.board->downhill;
  const std::optional<Eigen::Vector2d> from = project(middle), to = project(ahead);
  const Outline outline = project.outline(body.rest), bearing = project.outline(bodies_[body.board->mesh].rest);
  if (!from || !to || outline.empty() || bearing.empty()) return std::nullopt;
  const Eigen::AlignedBox2d both = box_of({outline, bearing});
  // What slides down towards the lower edge of the picture would slide into a caption there.
  const Eigen::Vector2d way = *to - *from;
  const bool above = way.y() > std::abs(way.x());
  const Eigen::Vector2d at(box_of({outline}).center().x(), above ? both.min().y() : both.max().y());
  const bool shown = at.x() > 0 && at.x() < width_ && at.y() > 0 && at.y() < height_;
  return shown ? std::optional(Anchor{at, above ? CaptionSide::above : CaptionSide::below}) : std::nullopt;
}

// boards: whether the caption of a body on a board stands beside both.
std::optional<Captions::Anchor> Captions::anchor_of(const Projection& project, const Body& body, bool boards) const {
  if (const std::optional<Anchor> anchor = boards ? beside_board(project, body) : std::nullopt) return anchor;
  const std::optional<Eigen::Vector2d> foot = foot_of(project, body, body.rest.upper.z());
  return foot ? std::optional(Anchor{*foot, CaptionSide::below}) : std::nullopt;
}

// Tries to place all captions in letters of one size. Returns how far they stand from their wanted places, all together
// [pixels]; nothing where one has no place.
std::optional<double> Captions::try_size(const Camera& camera, int em, const Demand& demand) {
  const Projection project(camera, around_, width_, height_);
  const int line = draw_caption(font_, "X", em).height, halo = Sticker::halo(em);
  const int note_em = std::max(8, static_cast<int>(std::lround(note_size * em)));
  const int note_width = width_of(note_template_, note_em);
  const int height = line + 2 * halo + (note_template_.empty() ? 0 : draw_caption(font_, "X", note_em).height);
  const double gap = 0.012 * height_for_letters(width_, height_);
  std::vector<WantedCaption> wanted;
  std::vector<Outline> bodies;
  placed_.clear();
  em_ = em;
  for (std::size_t m = 0; m < bodies_.size(); ++m) {
    const Body& body = bodies_[m];
    Outline outline = body.kept_clear ? project.outline(body.rest) : Outline();
    const auto anchor = anchor_of(project, body, demand.boards);
    if (!body.label.empty() && anchor) {
      const int width = std::max(width_of(body.label, em), note_width) + 2 * halo;
      const bool above = anchor->side == CaptionSide::above;
      const double edge = above ? anchor->at.y() - gap
                                : std::min(anchor->at.y() + gap, demand.over_bodies ? height_ - 2.0 * height : 1e9);
      wanted.push_back({{anchor->at.x(), edge}, width, height, anchor->side});
      placed_.push_back({m, {}});
    }
    if (!outline.empty()) bodies.push_back(std::move(outline));
  }
  const auto places = caption_places(
      wanted, {demand.over_bodies ? std::vector<Outline>() : bodies, taken_, width_, height_}, demand.reach);
  if (!places) return std::nullopt;
  over_body_.clear();
  double away = 0;
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const PixelRect& place = placed_[i].place = (*places)[i];
    const double edge = wanted[i].side == CaptionSide::above ? place.bottom() : place.y;
    away += (Eigen::Vector2d(place.x + 0.5 * place.width, edge) - wanted[i].edge).norm();
    over_body_.push_back(std::ranges::any_of(bodies, [&](const Outline& body) { return overlaps(place, body); }));
  }
  return away;
}

// Places as many captions as have room, in the order of the scene.
void Captions::drop_unplaced(const Camera& camera, int em) {
  constexpr Demand in_front = {CaptionReach::anywhere, false, true};
  const std::vector<Body> all = bodies_;
  for (Body& body : bodies_) body.label.clear();
  for (std::size_t m = 0; m < bodies_.size(); ++m) {
    bodies_[m].label = all[m].label;
    if (!try_size(camera, em, in_front)) bodies_[m].label.clear();
  }
  try_size(camera, em, in_front);
  bodies_ = all;
}

const std::vector<Captions::Placed>& Captions::places(const Camera& camera, const std::optional<Followed>& followed) {
  const Camera& layout = first_camera_ ? *first_camera_ : camera;
  if (!camera_ || !same(*camera_, layout)) lay_out(layout);
  if (first_camera_) go_along(camera, followed);
  return placed_;
}

void Captions::lay_out(const Camera& camera) {
  camera_ = camera;
  placed_.clear();
  stickers_.clear();
  if (font_.empty()) return;
  const int height = height_for_letters(width_, height_);
  const int largest = std::max(9, static_cast<int>(std::lround(height / 32.0)));
  const int smallest = std::max(8, static_cast<int>(std::lround(height / 60.0)));
  const int step = std::max(1, largest / 12);
  const bool have_boards = std::ranges::any_of(bodies_, [](const Body& body) { return body.board.has_value(); });
  bool done = false;
  // Small letters beside their body say more than large ones that could belong to another.
  for (const Demand& demand :
       {Demand{CaptionReach::near, true, false}, Demand{CaptionReach::near, false, false},
        Demand{CaptionReach::anywhere, true, false}, Demand{CaptionReach::anywhere, false, false},
        Demand{CaptionReach::anywhere, false, true}}) {
    if (done || (demand.boards && !have_boards)) continue;
    // Where they cannot all be near, they grow as long as that moves each of them by less than a line.
    std::optional<double> most;
    if (demand.reach == CaptionReach::anywhere && !demand.over_bodies) {
      most = try_size(camera, smallest, demand);
      if (!most) continue;
      *most += smallest * static_cast<double>(placed_.size());
    }
    for (int em = largest; em >= smallest && !done; em -= step) {
      const std::optional<double> away = try_size(camera, em, demand);
      done = away && (!most || *away <= *most);
    }
    if (!done && most) done = try_size(camera, smallest, demand).has_value();
  }
  if (!done) drop_unplaced(camera, smallest);
  for (const Placed& one : placed_) {
    Sticker sticker(one.place.width, one.place.height);
    const std::string& label = bodies_[one.mesh].label;
    sticker.text_with_halo(font_, label, em_, (one.place.width - width_of(label, em_)) / 2, Sticker::halo(em_), ink_);
    stickers_.push_back(std::move(sticker));
  }
  laid_out_ = placed_;
}

// Moves all captions as far as the feet of their bodies have moved in the picture. A caption of a body that has left
// the picture goes with it; its place is then outside.
void Captions::go_along(const Camera& camera, const std::optional<Followed>& followed) {
  const Projection before(*first_camera_, around_, width_, height_), now(camera, around_, width_, height_);
  placed_ = laid_out_;
  for (Placed& one : placed_) {
    Body body = bodies_[one.mesh];
    const auto from = foot_of(before, body, body.rest.center().z());
    if (followed && followed->mesh == one.mesh) {
      // It moves along the ground with its body, and not up and down.
      const Vec3 moved(followed->moved.x(), 0, followed->moved.z());
      body.rest.lower += moved;
      body.rest.upper += moved;
    }
    const auto to = foot_of(now, body, body.rest.center().z());
    const bool behind = !from || !to;
    one.place.x = behind ? -2 * one.place.width : one.place.x + static_cast<int>(std::lround(to->x() - from->x()));
    one.place.y = behind ? -2 * one.place.height : one.place.y + static_cast<int>(std::lround(to->y() - from->y()));
  }
}

void Captions::draw(Image& image, const DrawList& list) {
  places(list.camera, list.followed);
  const int note_em = std::max(8, static_cast<int>(std::lround(note_size * em_)));
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const PixelRect& place = placed_[i].place;
    if (place.right() < 0 || place.bottom() < 0 || place.x >= width_ || place.y >= height_) continue;
    stickers_[i].onto(image, place.x, place.y);
    if (placed_[i].mesh >= list.notes.size() || list.notes[placed_[i].mesh].empty()) continue;
    const std::string& text = list.notes[placed_[i].mesh];
    const int halo = Sticker::halo(note_em), width = width_of(text, note_em);
    Sticker note(width + 2 * halo, draw_caption(font_, "X", note_em).height + 2 * halo);
    note.text_with_halo(font_, text, note_em, halo, halo, ink_);
    note.onto(image, place.x + (place.width - note.width()) / 2, place.bottom() - note.height() + halo);
  }
}

}  // namespace supple
