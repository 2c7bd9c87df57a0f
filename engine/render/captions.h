// Lays the captions of bodies over the finished picture: each below its body, and none over another or over a body that
// stands where it stood at the start. The caption of a body on a collider of its own, called its board here, is read as
// that of both and stands beside both: below them, or above them where the board leads the body down in the picture.
// Where there is little room, all captions become smaller together; captions.cpp begins with their sizes. They are laid
// out for the first picture. Where the camera moves, each caption goes along in the picture with the place where its
// body starts, and does not jump; that of a body which the camera follows stays where it is in the picture. Not here:
// the words (a mesh's label is BodyDef::label, notes are from film/pictures/picture_words.h), and the search for free
// places (caption_layout.h).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/caption_layout.h"
#include "render/draw_list.h"
#include "render/projection.h"

namespace supple {

class Captions {
 public:
  // There are no captions when the stage has no font. taken: places of other things that are laid over the picture.
  // subtitles: the room of all subtitles; captions stay out of it if all of them then have places near their bodies.
  explicit Captions(const Stage& stage, std::vector<PixelRect> taken = {}, const PixelRect& subtitles = {});

  // Replaces the caption of a mesh.
  void renew(std::size_t mesh, const std::string& label);

  // Holds the place of a mesh's caption in the picture of a camera.
  struct Placed {
    std::size_t mesh;
    PixelRect place;
  };
  // Returns the places of all captions that are drawn. A caption for which even small letters find no place that is
  // free of other captions is left out; so is that of a body that the camera has left behind.
  const std::vector<Placed>& places(const Camera& camera, const std::optional<Followed>& followed = {});

  // Tells whether a caption stands in front of a body, because there was no other room. placed: its number in places().
  bool over_a_body(std::size_t placed) const { return over_body_[placed]; }

  // Draws the captions and, below each, the list's note on its mesh. Those that the picture's subtitle would cover are
  // left out. subtitle: its place; without size where there is none.
  void draw(Image& image, const DrawList& list, const PixelRect& subtitle = {});

 private:
  struct Body {
    std::string label;
    Bounds rest;
    bool kept_clear = false;
    std::optional<Board> board = {};
  };
  // Holds the place beside which a caption stands.
  struct Anchor {
    Eigen::Vector2d at;
    CaptionSide side;
  };
  // Tells what the places of a layout must be like; lay_out() tries several demands, one after the other.
  struct Demand {
    CaptionReach reach;
    bool boards;       // whether captions stand beside the boards of their bodies
    bool over_bodies;  // whether captions may stand in front of bodies
  };
  std::optional<Eigen::Vector2d> foot_of(const Projection& project, const Body& body, double z) const;
  std::optional<Anchor> beside_board(const Projection& project, const Body& body) const;
  std::optional<Anchor> anchor_of(const Projection& project, const Body& body, bool boards) const;
  std::optional<double> try_size(const Camera& camera, int em, const Demand& demand);
  // Gives the heights of letters that are tried, from the largest down [pixels].
  struct LetterSizes {
    int largest, smallest, step;
  };
  bool find_places(const Camera& camera, const LetterSizes& sizes, std::span<const Demand> demands);
  void lay_out(const Camera& camera);
  void go_along(const Camera& camera, const std::optional<Followed>& followed);
  void drop_unplaced(const Camera& camera, int em);
  int width_of(const std::string& text, int em) const;

  Font font_;
  std::string note_template_;
  int width_, height_;
  double gap_;  // between a body and its caption [pixels]
  Vec3 ink_;    // of the letters [sRGB]
  Bounds around_;
  std::vector<PixelRect> taken_;
  PixelRect subtitles_;
  std::vector<Body> bodies_;               // by mesh of the stage
  std::vector<Placed> placed_, laid_out_;  // places in the picture in hand, and in that of the layout's camera
  std::optional<Camera> first_camera_;     // the camera of the layout where the camera moves; nothing where it does not
  std::vector<bool> over_body_;            // in the order of placed_: whether the caption stands in front of a body
  std::vector<Sticker> stickers_;          // of the labels, in the order of placed_
  int em_ = 0;                             // the height of the letters that was chosen [pixels]
  std::optional<Camera> camera_;           // the camera of the layout; nothing where captions must be laid out
};

}  // namespace supple
