#include "render/captions.h"

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
  for (const DrawMesh& mesh : stage.meshes) bodies_.push_back({mesh.label, mesh.rest, mesh.kept_clear});
}

void Captions::renew(std::size_t mesh, const std::string& label) {
  bodies_[mesh].label = label;
  camera_.reset();
}

int Captions::width_of(const std::string& text, int em) const {
  return text.empty() ? 0 : draw_caption(font_, text, em).width;
}

// Returns the pixel below which a body's caption stands; nothing behind the eye. The caption stands on the ground: for
// a body that hangs in the air, below the place where it starts. z: of the part below which it
// stands [m].
std::optional<Eigen::Vector2d> Captions::foot_of(const Projection& project, const Body& body, double z) const {
  std::optional<Eigen::Vector2d> foot = project({body.rest.center().x(), std::min(body.rest.lower.y(), 0.0), z});
  if (!foot || !body.kept_clear) return foot;
  for (const Eigen::Vector2d& corner : project.outline(body.rest)) foot->y() = std::max(foot->y(), corner.y());
  return foot;
}

// Tries to place all captions in letters of one size. Returns whether each has a place.
bool Captions::try_size(const Camera& camera, int em, bool over_bodies) {
  const Projection project(camera, around_, width_, height_);
  const int line = draw_caption(font_, "X", em).height, halo = Sticker::halo(em);
  const int note_em = std::max(8, static_cast<int>(std::lround(note_size * em)));
  const int note_width = width_of(note_template_, note_em);
  const int height = line + 2 * halo + (note_template_.empty() ? 0 : draw_caption(font_, "X", note_em).height);
  std::vector<WantedCaption> wanted;
  std::vector<Outline> bodies;
  placed_.clear();
  em_ = em;
  for (std::size_t m = 0; m < bodies_.size(); ++m) {
    const Body& body = bodies_[m];
    Outline outline = body.kept_clear ? project.outline(body.rest) : Outline();
    const auto foot = foot_of(project, body, body.rest.upper.z());
    if (!body.label.empty() && foot) {
      double lowest = foot->y();
      const int width = std::max(width_of(body.label, em), note_width) + 2 * halo;
      lowest = std::min(lowest + 0.012 * height_, over_bodies ? height_ - 2.0 * height : 1e9);
      wanted.push_back({{foot->x(), lowest}, width, height});
      placed_.push_back({m, {}});
    }
    if (!outline.empty()) bodies.push_back(std::move(outline));
  }
  const auto places = caption_places(wanted, over_bodies ? std::vector<Outline>() : bodies, taken_, width_, height_);
  if (!places) return false;
  over_body_.clear();
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    placed_[i].place = (*places)[i];
    over_body_.push_back(
        std::ranges::any_of(bodies, [&](const Outline& body) { return overlaps(placed_[i].place, body); }));
  }
  return true;
}

// Places as many captions as have room, in the order of the scene.
void Captions::drop_unplaced(const Camera& camera, int em) {
  const std::vector<Body> all = bodies_;
  for (Body& body : bodies_) body.label.clear();
  for (std::size_t m = 0; m < bodies_.size(); ++m) {
    bodies_[m].label = all[m].label;
    if (!try_size(camera, em, true)) bodies_[m].label.clear();
  }
  try_size(camera, em, true);
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
  const int largest = std::max(9, static_cast<int>(std::lround(height_ / 32.0)));
  const int smallest = std::max(8, static_cast<int>(std::lround(height_ / 60.0)));
  bool done = false;
  for (const bool over_bodies : {false, true}) {
    for (int em = largest; em >= smallest && !done; em -= std::max(1, largest / 12))
      done = try_size(camera, em, over_bodies);
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
