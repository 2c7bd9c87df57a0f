// Describes what is to be drawn, as plain arrays, without GL and without physics. A Stage is given once, a DrawList for
// each frame.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/finish.h"
#include "base/texture.h"
#include "base/types.h"
#include "render/font.h"
#include "render/light_rig.h"

namespace supple {

struct PaintColor {
  Vec3 color;    // sRGB
  double gloss;  // 0 matt to 1 wet
  double soft;   // width of the border, in the unit of DrawMesh::paint
};

enum class Printed { grid, checks };

// Describes the colours of a field that surfaces show, and its legend.
struct FieldLook {
  std::vector<Vec3> colors;                           // from the low end of the range to the high one [sRGB]
  std::string title;                                  // of the legend, with the unit; no legend when empty
  std::vector<std::pair<double, std::string>> ticks;  // place from 0 (low) to 1 (high), and the value there
};

// Describes a small graph of one number a frame over the film, without its curve.
struct GraphLook {
  std::string title;                                  // with the unit
  std::vector<std::pair<double, std::string>> ticks;  // place from 0 (bottom) to 1 (top), and the value there
  int frames = 1;                                     // of the whole film; the width of the graph stands for them all
};

// Describes how far a graph's curve has come.
struct GraphCurve {
  // Both lists have one entry for each frame so far, from 0 at the bottom to 1 at the top; NaN where there is nothing.
  std::vector<double> line, dots;
};

// This value of a field at a vertex says that there is none.
constexpr float no_field = -1;

// Describes the collider on which a body comes down, beside which its caption stands too. (What holds bodies at their
// handles is called a support: scene/building/support.h.)
struct Board {
  std::size_t mesh;  // of the collider
  // The direction in which its surface falls under the body, as long as the sine of the angle; zero where it is level.
  Vec3 downhill;
};

// Describes what only cloth has.
struct ClothLook {
  std::optional<Vec3> back;  // colour of its back; a darker and paler tone of the front's where there is none [sRGB]
  double yarn = 0;           // distance from one yarn to the next; 0: none are seen [m]
  double hem = 0;            // width of the hem along open borders; 0: there is none [m]
  bool operator==(const ClothLook&) const = default;
};

// Describes a surface whose vertices move while its other attributes stay.
struct DrawMesh {
  std::string name;                             // name of its mask; when empty, it is in no mask
  std::string label;                            // caption; none when empty
  std::vector<std::uint32_t> triangles;         // vertex indices, three a triangle, anticlockwise from outside
  std::vector<std::uint32_t> shadow_triangles;  // the triangles that cast its shadow; when empty, `triangles` do
  std::vector<float> occlusion;                 // by vertex, from 1 (open sky) to 0 (no sky)
  std::vector<std::array<float, 8>> paint;      // by vertex: signed distance to each layer, negative where it covers
  std::vector<std::array<float, 2>> square;  // by vertex: place in a printed pattern, in squares; no pattern when empty
  Printed printed = Printed::grid;
  std::vector<SurfaceColor> surface_colors;  // by vertex, in place of `color`; empty where that is the colour
  std::vector<std::uint32_t> smooth;         // by vertex: those of one number have one normal; empty: each its own
  std::shared_ptr<const std::vector<Texture>> textures;  // of the surface's colours; null: none
  std::vector<std::array<float, 3>> flat;  // by vertex of cloth: x y when flat, and distance from an open border [m]
  std::optional<ClothLook> cloth;          // nothing: it is no cloth
  bool two_sided = false;                  // for cloth, and for bodies that may be inside out
  Vec3 color;                              // sRGB colour of the uncovered surface
  double gloss = 0.25;                     // gloss of the uncovered surface
  Finish finish;                           // its roughness counts in the place of that gloss
  std::vector<PaintColor> layers;          // at most 8
  Bounds rest;                             // bounds at the start: captions stand below them, cameras frame them [m]
  bool mapped = false;                     // whether it shows the field; its own colours are then not seen
  bool wires = false;                      // whether the edges of its triangles are drawn
  bool ghost = false;                      // whether it is half transparent, and casts no shadow
  bool kept_clear = false;                 // whether captions stay away from it
  std::optional<Board> board = {};         // of a body; nothing where the collider bears others, too
  bool framed = true;                      // whether lights, shadows and cameras cover it; false for planes without end
};

// Chooses what is seen behind the bodies.
enum class Backdrop {
  ground,       // a ground with shadows, which fades into the background
  plain,        // the colour of the background alone
  transparent,  // nothing: pictures have coverage
  shadows,      // nothing but the ground's shadows, which are black with coverage
};

constexpr bool has_coverage(Backdrop backdrop) {
  return backdrop == Backdrop::transparent || backdrop == Backdrop::shadows;
}

// Holds what a replay may change of a stage: its colours [sRGB] and the exposure.
struct StageColors {
  Vec3 ground = Vec3::Ones(), background = Vec3::Ones();
  double exposure = 1;
  bool operator==(const StageColors&) const = default;
};

struct Camera {
  Vec3 eye = Vec3(0, 0, 3), target = Vec3::Zero();  // [m]
  double fov_deg = 30;                              // vertical field of view
  // How far the picture is moved on its plane, to the right and up, as tangents of angles. A picture from a place on
  // the lens beside its middle is moved so that what is in focus stays where it is.
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  bool operator==(const Camera&) const = default;
};

struct Stage {
  Backdrop backdrop = Backdrop::ground;
  std::vector<DrawMesh> meshes;
  // The outermost points of all bodies over the film, which cameras frame in place of the bodies' boxes at rest; empty:
  // not known [m]
  std::vector<Vec3> motion;
  int width = 1280, height = 720;  // pixels
  int samples = 4;                 // samples a pixel, for antialiasing
  StageColors colors;
  LightRig light = studio_light();
  Font font;                           // of all words; no captions when empty
  std::optional<FieldLook> field;      // that meshes show
  double kept_free = 0;                // share of the width that framing cameras keep free at each side, for the legend
  std::string note_template;           // a note as long as any below a caption; there are none when empty
  std::string headline_template;       // a line as long as any at the top of the picture; there is none when empty
  std::vector<std::string> subtitles;  // all that stand at the lower edge in some picture
  std::vector<GraphLook> graphs;
  Camera first_camera;  // at the start of the film: places of graphs, and of captions where it moves, suit its picture
  bool camera_moves = false;  // over the film
};

// Describes what the camera goes along with.
struct Followed {
  std::size_t mesh;
  Vec3 moved;  // of its middle since the start [m]
};

// Describes what a picture is exposed to besides the moment of its frame: a span of time, and a lens (exposure.h).
struct Exposure {
  std::vector<std::vector<float>> before;  // by mesh: positions in the frame before; empty: nothing moves [m]
  Camera camera_before;                    // the camera in the frame before
  double open = 0;                         // share of the time between the two frames, up to the later one
  double aperture = 0;                     // diameter of the lens [m]
  double focus = 1;                        // distance along the direction of the view at which things are sharp [m]
  int samples = 0;                         // number of pictures; 0: as many as the blur asks for
};

struct DrawList {
  Camera camera;
  std::optional<Followed> followed;
  std::vector<std::vector<float>> positions;  // by mesh: x y z by vertex [m]
  std::vector<std::vector<float>>
      field;  // by mesh: by vertex, from 0 (low) to 1 (high) or no_field; empty if not mapped
  std::vector<std::vector<float>>
      hollow;  // by mesh: by vertex, from -1 (ridge of a fold) to 1 (valley), of the front; empty: no cloth
  std::vector<std::pair<std::size_t, DrawMesh>> renewed;      // meshes that replace the stage's from now on
  std::vector<std::pair<std::size_t, std::string>> captions;  // captions of meshes from now on
  std::vector<std::string> notes;                             // by mesh: what stands below its caption in this frame
  std::vector<std::array<float, 4>> marks;                    // x y z [m], and 0 for a handle or 1 for a contact
  std::optional<StageColors> colors;                          // that replace the stage's from now on
  std::string headline;                                       // at the top of the picture, in this frame
  std::string subtitle;                                       // at its lower edge, in this frame; one of the stage's
  std::vector<GraphCurve> graphs;                             // the curves of the stage's graphs up to this frame
  std::optional<Exposure> exposure;                           // nothing: the picture is that of an instant, all sharp
};

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // rows from the top
  std::vector<std::uint8_t> alpha =
      {};  // coverage by pixel, by which the colours are not multiplied; empty: all is covered
};

// Returns the colour of the background as pictures show it [sRGB].
Vec3 backdrop_of(const Stage& stage);

// Returns the colours of a picture over a background [sRGB].
std::vector<std::uint8_t> over(const Image& image, const Vec3& background);

}  // namespace supple
