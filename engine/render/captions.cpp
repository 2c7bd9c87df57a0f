#include "render/captions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "render/legend.h"
#include "render/projection.h"
#include "render/text_bitmap.h"

namespace supple {
namespace {

// The letters of captions are as high as the picture (height_for_letters) divided by the first of these numbers; where
// there is little room they become smaller, down to the height divided by the second one.
constexpr double heights_in_picture = 32, most_heights_in_picture = 60;
constexpr double note_size = 0.8;  // the height of a note's letters, over that of the caption's

bool same(const Camera& a, const Camera& b) { return a.eye == b.eye && a.target == b.target && a.fov_deg == b.fov_deg; }

}  // namespace

Captions::Captions(const Stage& stage, std::vector<PixelRect> taken, const PixelRect& subtitles)
    : font_(stage.font),
      note_template_(stage.note_template),
      width_(stage.width),
      height_(stage.height),
      gap_(0.012 * height_for_letters(stage.width, stage.height)),
      ink_(ink_on(stage)),
      around_(framed_at_start(stage)),
      taken_(std::move(taken)),
      subtitles_(subtitles) {
  if (stage.camera_moves) first_camera_ = stage.first_camera;
  for (const DrawMesh& mesh : stage.meshes) bodies_.push_back({mesh.label, mesh.rest, mesh.kept_clear, mesh.board});
}

void Captions::renew(std::size_t mesh, const std::string& label) {
  bodies_[mesh].label = label;
  camera_.reset();
}

int Captions::width_of(const std::string& text, int em) const {
  return text.empty() ? 0 : draw_text(font_, text, em).width;
}

// Returns the pixel below which a body's caption stands; nothing behind the eye. The caption stands on the ground: for
// a body that hangs in the air, below the place where it starts. z: the coordinate of the part of the body below which
// it stands [m].
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
  const int line = draw_text(font_, "X", em).height, halo = Sticker::halo(em);
  const int note_em = std::max(8, static_cast<int>(std::lround(note_size * em)));
  const int note_width = width_of(note_template_, note_em);
  const int height = line + 2 * halo + (note_template_.empty() ? 0 : draw_text(font_, "X", note_em).height);
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
      const double edge = above ? anchor->at.y() - gap_
                                : std::min(anchor->at.y() + gap_, demand.over_bodies ? height_ - 2.0 * height : 1e9);
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

// Looks for places that meet the first demand that can be met, in letters as large as can be. Returns whether it has
// found them.
bool Captions::find_places(const Camera& camera, const LetterSizes& sizes, std::span<const Demand> demands) {
  const bool have_boards = std::ranges::any_of(bodies_, [](const Body& body) { return body.board.has_value(); });
  bool done = false;
  for (const Demand& demand : demands) {
    if (done || (demand.boards && !have_boards)) continue;
    // If captions cannot all be near their bodies, letters become as large as possible, as long as captions stand less
    // than a line further away, on average, than they do with the smallest letters.
    std::optional<double> most;
    if (demand.reach == CaptionReach::anywhere && !demand.over_bodies) {
      most = try_size(camera, sizes.smallest, demand);
      if (!most) continue;
      *most += sizes.smallest * static_cast<double>(placed_.size());
    }
    for (int em = sizes.largest; em >= sizes.smallest && !done; em -= sizes.step) {
      const std::optional<double> away = try_size(camera, em, demand);
      done = away && (!most || *away <= *most);
    }
    if (!done && most) done = try_size(camera, sizes.smallest, demand).has_value();
  }
  return done;
}

void Captions::lay_out(const Camera& camera) {
  camera_ = camera;
  placed_.clear();
  stickers_.clear();
  if (font_.empty()) return;
  const int height = height_for_letters(width_, height_);
  const int largest = std::max(9, static_cast<int>(std::lround(height / heights_in_picture)));
  const int smallest = std::max(8, static_cast<int>(std::lround(height / most_heights_in_picture)));
  const LetterSizes sizes = {largest, smallest, std::max(1, largest / 12)};
  // Small letters beside their body say more than large ones that could belong to another.
  constexpr std::array demands = {Demand{CaptionReach::near, true, false}, Demand{CaptionReach::near, false, false},
                                  Demand{CaptionReach::anywhere, true, false},
                                  Demand{CaptionReach::anywhere, false, false},
                                  Demand{CaptionReach::anywhere, false, true}};
  bool done = false;
  if (subtitles_.width > 0) {
    taken_.push_back(subtitles_);
    done = find_places(camera, sizes, std::span(demands).first(2));
    taken_.pop_back();
  }
  if (!done) done = find_places(camera, sizes, demands);
  if (!done) drop_unplaced(camera, sizes.smallest);
  for (const Placed& one : placed_) {
    Sticker sticker(one.place.width, one.place.height);
    const std::string& label = bodies_[one.mesh].label;
    sticker.text_with_halo(font_, label, em_, (one.place.width - width_of(label, em_)) / 2, Sticker::halo(em_), ink_);
    stickers_.push_back(std::move(sticker));
  }
  laid_out_ = placed_;
}

namespace {

// Returns the pixel where a box ends at its lower side in the picture, below its middle; nothing where part of it lies
// behind the eye.
std::optional<Eigen::Vector2d> end_of(const Projection& project, const Bounds& box) {
  const auto middle = project({box.center().x(), box.lower.y(), box.center().z()});
  const Outline outline = project.outline(box);
  if (!middle || outline.empty()) return std::nullopt;
  return Eigen::Vector2d(middle->x(), box_of({outline}).max().y());
}

}  // namespace

// Moves each caption in the picture by as much as the lower end of its body's box has moved there since the layout. The
// box of the body that the camera follows is taken where the body is in this frame, so that its caption hardly moves in
// the picture. The boxes of other bodies are those at the start, extended down to the ground: their captions stay at
// places on the ground, as they do before a camera that stands still. A caption below its body keeps at least the
// distance gap_ from the box, except where the lower edge of the picture holds it up; there it may come as near to the
// box as in the layout. A caption leaves the picture as its box does, and is put outside where part of the box lies
// behind the eye.
void Captions::go_along(const Camera& camera, const std::optional<Followed>& followed) {
  const Projection before(*first_camera_, around_, width_, height_), now(camera, around_, width_, height_);
  placed_ = laid_out_;
  for (Placed& one : placed_) {
    Bounds at_start = bodies_[one.mesh].rest, there = at_start;
    if (followed && followed->mesh == one.mesh) {
      there = {at_start.lower + followed->moved, at_start.upper + followed->moved};
    } else {
      at_start.lower.y() = there.lower.y() = std::min(at_start.lower.y(), 0.0);
    }
    const auto from = end_of(before, at_start), to = end_of(now, there);
    if (!from || !to) {
      one.place.x = -2 * one.place.width;
      one.place.y = -2 * one.place.height;
      continue;
    }
    const Outline body = before.outline(bodies_[one.mesh].rest);
    const bool below = !body.empty() && one.place.y > box_of({body}).center().y();
    const double laid = one.place.y - from->y(), clear = below ? std::max(laid, gap_) : laid;
    const double beyond = to->y() + clear + one.place.height - (height_ - picture_margin(width_, height_));
    one.place.x += static_cast<int>(std::lround(to->x() - from->x()));
    one.place.y = static_cast<int>(std::lround(to->y() + clear - std::clamp(beyond, 0.0, clear - laid)));
  }
}

void Captions::draw(Image& image, const DrawList& list, const PixelRect& subtitle) {
  places(list.camera, list.followed);
  const int note_em = std::max(8, static_cast<int>(std::lround(note_size * em_)));
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const PixelRect& place = placed_[i].place;
    if (place.right() < 0 || place.bottom() < 0 || place.x >= width_ || place.y >= height_) continue;
    if (subtitle.width > 0 && place.overlaps(subtitle)) continue;
    stickers_[i].onto(image, place.x, place.y);
    if (placed_[i].mesh >= list.notes.size() || list.notes[placed_[i].mesh].empty()) continue;
    const std::string& text = list.notes[placed_[i].mesh];
    const int halo = Sticker::halo(note_em), width = width_of(text, note_em);
    Sticker note(width + 2 * halo, draw_text(font_, "X", note_em).height + 2 * halo);
    note.text_with_halo(font_, text, note_em, halo, halo, ink_);
    note.onto(image, place.x + (place.width - note.width()) / 2, place.bottom() - note.height() + halo);
  }
}

}  // namespace supple
