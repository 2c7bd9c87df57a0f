// Defines a scene as its file describes it: plain nested structs with defaults, in SI units, with angles in degrees
// where the name says so. The defaults here are those of the file format, except for values that a file must give and
// defaults that depend on other keys: the readers set those. Nothing is built yet (assemble.h), and nothing here
// depends on scene files or TOML (scene_reader.h).
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/finish.h"
#include "base/frame_rate.h"
#include "base/names.h"
#include "base/picture_pass.h"
#include "geometry/files/source_file.h"
#include "geometry/skins/skin.h"
#include "scene/definition/start_state.h"
#include "scene/definition/surface_motion.h"
#include "scene/definition/warning_kinds.h"
#include "sim/model/inputs.h"
#include "sim/model/method.h"
#include "sim/model/model.h"

namespace supple {

// Selects vertices of a body by a box, ball, half space or region, by their numbers, as those nearest to points, or by
// what the file of a surface says of them: the name of a group or material, or a colour. Coordinates are relative to
// the rest bounding box (0 to 1 along each axis).
struct Selection {
  enum class Kind { region, box, sphere, plane, vertices, nearest, group, color } kind = Kind::box;
  std::string region;
  std::vector<int> vertices;                          // numbers, counted from 1
  Vec3 lower = Vec3(0, 0, 0), upper = Vec3(1, 1, 1);  // box
  Vec3 center = Vec3(0, 0, 0);                        // sphere; a point of the plane
  double radius = 0;                                  // sphere; relative to the longest side
  Vec3 normal = Vec3(0, 1, 0);                        // plane: picks the side that it points to
  std::vector<Vec3> points;                           // nearest
  std::string group;                                  // a name in the file
  Vec3 color = Vec3(0, 0, 0);                         // [sRGB]
  double tolerance = 0.1;                             // of each channel of the colour
  bool border = false;                                // of these, only those on the open border of a cloth
  FilePlace place;                                    // in the file, for messages once the mesh is known
};

template <>
struct Names<Selection::Kind> {
  using Kind = Selection::Kind;
  static constexpr std::array table = {Name{Kind::region, "region"},     Name{Kind::box, "box"},
                                       Name{Kind::sphere, "sphere"},     Name{Kind::plane, "plane"},
                                       Name{Kind::vertices, "vertices"}, Name{Kind::nearest, "nearest"},
                                       Name{Kind::group, "group"},       Name{Kind::color, "color"}};
};

struct MotionKey {
  double time = 0;                // [s]
  Vec3 move = Vec3(0, 0, 0);      // from rest [m]
  Vec3 turn_deg = Vec3(0, 0, 0);  // about the handle's centre, or the collider's origin
};

enum class Ease { smooth, linear };
template <>
struct Names<Ease> {
  static constexpr std::array table = {Name{Ease::smooth, "smooth"}, Name{Ease::linear, "linear"}};
};

// Names what takes a handle along: a collider or another body.
struct AttachDef {
  std::string collider, body;  // one of the two is empty
  FilePlace place;
};

struct HandleDef {
  std::string name;
  Selection select;
  double stiffness = 0;  // of the spring from each vertex to its target, 0: hard [N/m]
  // A handle that grabs holds its vertices from one time to another [s]. Its keys are relative to the vertices'
  // positions when it begins to hold them.
  bool grabs = false;
  double from = 0, until = std::numeric_limits<double>::infinity();
  Ease ease = Ease::smooth;
  std::vector<MotionKey> keys;
  std::optional<AttachDef> attach;  // what its vertices go with; it then has no keys and takes hold at the start

  // Tells whether the handle holds its vertices in a step that starts at a time [s].
  bool holds_at(double time) const { return time >= from - 1e-9 && time < until - 1e-9; }
};

// Describes the material of a body or of one of its regions.
struct SubstanceDef {
  Material material = Polynomial{1};
  Fibre fibre;                          // its direction in the frame of the mesh or shape
  std::optional<double> usual_density;  // of a preset [kg/m^3]
};

struct RegionDef {
  std::string name;
  SubstanceDef substance;
  FilePlace place;
};

// Describes a box that is cut into equal cells.
struct BoxDef {
  Vec3 extent = Vec3(1, 1, 1);  // [m]
  Eigen::Vector3i cells = Eigen::Vector3i(1, 1, 1);
};

// Describes what a cloth is made of where it is no net of springs.
struct FabricDef {
  Fabric fabric;
  std::optional<double> usual_density;  // of a preset [kg/m^2]
};

// Says in which shape each triangle of a surface is at rest.
enum class ClothCut {
  surface,  // as it lies in the file
  texture,  // as it lies flat in the texture, whose coordinates are those of the pieces when they were cut
};
template <>
struct Names<ClothCut> {
  static constexpr std::array table = {Name{ClothCut::surface, "surface"}, Name{ClothCut::texture, "texture"}};
};

// Describes a cloth: a grid, the triangles of a mesh file, or those of a surface. It is made of a fabric, or of
// springs.
struct ClothDef {
  std::filesystem::path mesh, surface;             // both empty: a grid
  Eigen::Vector2d extent = Eigen::Vector2d(1, 1);  // of the grid [m]
  Eigen::Vector2i cells = Eigen::Vector2i(40, 40);
  std::optional<double> edge;  // wanted mean length of edges; the triangles stay as they are [m]
  Vec3 grain = Vec3(0, 1, 0);  // direction of the warp, in the frame of the file; a triangle has it in its plane
  ClothCut cut = ClothCut::surface;
  std::optional<double> cut_scale;          // of one unit of the texture; nothing: as much as keeps the area [m]
  FilePlace cut_place;                      // in the file, for messages once the surface is known
  std::optional<double> sew;                // of vertices on the border that become one, the distance at most [m]
  std::optional<FabricDef> fabric;          // nothing: it is made of springs
  bool curved = false;                      // a fabric bends from the shape that the file has; else it is flat at rest
  double stretch = 0, shear = 0, bend = 0;  // stiffness of a spring [N/m]
};

// Describes how the steps of a body are solved: the table [solver]. `settings` are part of every step's inputs and cost
// nothing to change. The other members are built into the model (fit, precision, integrator, damping: assemble.cpp),
// select the rule for directions (method), or are read by MovingBody (calming, untangle). live_keys.cpp defines what a
// change of each costs.
struct SolverDef {
  Method method = Method::quasi_newton;
  SolverSettings settings;
  StretchInterval fit;
  Precision precision = Precision::single_precision;
  Integrator integrator = Integrator::backward_euler;
  double damping = 0;     // beta [s]
  double calming = 0;     // rate at which movement within the body dies down (sim/solver/calming.h) [1/s]
  bool untangle = false;  // makes steps that start tangled those of a body as rigid as possible (moving_body.h)
};

// Chooses what is done about a body that starts inside a collider.
enum class StartInside {
  move,   // the body is moved out when a small move is enough, or else pushed out
  push,   // the body is pushed out while the film runs
  error,  // the scene is refused
};
template <>
struct Names<StartInside> {
  static constexpr std::array table = {Name{StartInside::move, "move"}, Name{StartInside::push, "push"},
                                       Name{StartInside::error, "error"}};
};

// Tells which pieces of a surface become bodies.
enum class Pieces {
  join,     // pieces that overlap or touch are one body; any other piece is a body of its own
  largest,  // only the largest piece, after joining, becomes a body
  bodies,   // each piece is a body of its own
};
template <>
struct Names<Pieces> {
  static constexpr std::array table = {Name{Pieces::join, "join"}, Name{Pieces::largest, "largest"},
                                       Name{Pieces::bodies, "bodies"}};
};

// Chooses where the colour of a body made from a surface comes from.
enum class ColorSource {
  usual,  // the file where it has colours and the body has none, else the body
  file,   // the file where it has colours
  body,   // the body's `color`
};
template <>
struct Names<ColorSource> {
  static constexpr std::array table = {Name{ColorSource::usual, "usual"}, Name{ColorSource::file, "file"},
                                       Name{ColorSource::body, "body"}};
};

// Says what a body does with other bodies and with itself (meeting.h). The table solver.contact is about how contact
// with colliders is computed, and a collider has its own friction.
struct BodyContactDef {
  // Names the only bodies that it meets, none where the list is empty. Nothing: it meets all.
  std::optional<std::vector<std::string>> meets;
  FilePlace meets_place;   // of `meets` in the file, for messages once all bodies are known
  bool self = true;        // whether it touches itself
  bool skin = false;       // whether the drawn skin touches colliders in the stead of the elements
  double friction = 0.5;   // its share of the coefficient of Coulomb's law between it and another body
  double restitution = 0;  // the share of its speed that it keeps at least when it bounces off a collider or a body
};

struct BodySurface;  // body_pieces.h

struct BodyDef {
  std::string name;
  std::string table;  // the name that paths have: that of the body's table, which pieces of a surface share
  std::string label;  // the caption in pictures; empty: there is none
  std::vector<WarningKind> meant;  // warnings that need not be said
  // One of these five members gives the mesh. The regions of a mesh file are named by their reference numbers.
  std::filesystem::path shape;
  std::filesystem::path surface;
  SurfaceOptions surface_options;
  Pieces pieces = Pieces::join;                     // of the surface
  std::shared_ptr<const BodySurface> read_surface;  // what was read of `surface`; null: nothing yet
  std::size_t piece = 0;                            // number of the surface's piece that is this body
  std::filesystem::path mesh;
  std::optional<BoxDef> box;
  std::optional<ClothDef> cloth;
  int vertices = 0;               // of the tetrahedra made from a shape
  std::optional<double> size;     // longest side; otherwise the file's units are metres [m]
  double scale = 1;               // used where no size is given
  Vec3 position = Vec3(0, 0, 0);  // of the middle of the bounding box's bottom [m]
  Vec3 turn_deg = Vec3(0, 0, 0);
  Vec3 table_turn_deg = Vec3(0, 0, 0);  // without the random turn of a copy; copies share the skins of this turn
  std::optional<double> density;        // [kg/m^3]; of cloth [kg/m^2]
  std::optional<double> total_mass;     // spread over the volume, or over the area of cloth [kg]
  SubstanceDef substance;               // of solids
  std::optional<Plasticity> plastic;    // nothing: it keeps no dents
  std::optional<Creep> creep;           // nothing: it does not creep
  StartDef start;
  StartInside start_inside = StartInside::move;
  Vec3 velocity = Vec3(0, 0, 0);         // at the start [m/s]
  Vec3 spin_deg = Vec3(0, 0, 0);         // at the start, about the centre of mass [degrees/s]
  std::optional<DragCoefficients> drag;  // nothing: the usual ones on cloth, and none on solids
  std::optional<GasFilling> pressure;    // of gas in its surface
  FilePlace pressure_place;              // in the file, for messages once the surface is known
  BodyContactDef contact;
  std::vector<RegionDef> regions;
  std::vector<HandleDef> handles;
  SolverDef solver;
  Pattern pattern = Pattern::none;
  bool usual_pattern = false;          // the scene names no pattern, so that colours of a file have none over them
  std::optional<double> pattern_size;  // edge of the pattern's squares [m]
  std::optional<Vec3> color;           // replaces the shape's own colours [sRGB]
  std::optional<Vec3> back_color;      // of the back of cloth [sRGB]
  std::optional<double> yarn;          // between two yarns of cloth; 0: none are drawn [m]
  ColorSource colors = ColorSource::usual;
  std::optional<double> gloss;  // of the uncovered surface
  Finish finish;
  double skin_cells = 0;  // cells of the drawn skin along the longest side
  FilePlace place;

  bool flows() const { return plastic || creep; }
  bool takes_colors_of_file() const { return colors == ColorSource::usual ? !color : colors == ColorSource::file; }
  double body_density() const {
    if (!cloth) return density.value_or(substance.usual_density.value_or(1000));
    return density.value_or(cloth->fabric ? cloth->fabric->usual_density.value_or(0.2) : 0.2);
  }
};

// Describes an obstacle. Its shape is given in its own frame.
struct ColliderDef {
  std::string name;
  Shape shape;
  Vec3 position = Vec3(0, 0, 0);  // of its origin [m]
  Vec3 turn_deg = Vec3(0, 0, 0);
  double friction = 0;
  double restitution = 0;  // the share of its speed that a body keeps at least when it bounces off the collider
  double thickness = 0;    // [m]
  Ease ease = Ease::smooth;
  std::vector<MotionKey> keys;
  std::optional<SurfaceMotionDef> motion;  // nothing: it is rigid
  bool visible = true;
  std::optional<Vec3> color;  // [sRGB]
  Finish finish;
  FilePlace place;
};

// Describes a place of the camera on its way. Values that a key does not have come from the keys before and after it.
struct CameraKey {
  double time = 0;                                   // [s]
  std::optional<Vec3> position, target;              // [m]
  std::optional<double> azimuth_deg, elevation_deg;  // direction of the eye, as seen from the target
  std::optional<double> distance;                    // [m]
  std::optional<double> fov_deg;
};

// Names what a camera without a place of its own has in the picture.
enum class Framed {
  automatic,  // the whole motion where the bodies leave the picture of the start, by the same first pass; else the
              // start
  start,      // the bodies where they start, and the ground below those that will fall
  film,       // the bodies' whole motion, which a rough first pass finds, or a drawing knows
};
template <>
struct Names<Framed> {
  static constexpr std::array table = {Name{Framed::automatic, "auto"}, Name{Framed::start, "start"},
                                       Name{Framed::film, "film"}};
};

// Describes the camera. Without a position, the eye stands in the direction of azimuth and elevation, just far enough
// away to see all bodies.
struct CameraDef {
  std::optional<Vec3> position, target;  // [m]
  double azimuth_deg = 30, elevation_deg = 14;
  std::optional<double> distance;  // [m]
  double fov_deg = 30;             // vertical
  Framed frames = Framed::start;
  static constexpr double margin_of_motion = 1.05;
  double margin = 1.25;          // air around what is framed
  bool has_usual_margin = true;  // then it is margin_of_motion where the whole motion is framed
  double orbit_deg = 0;          // how fast the eye goes round the target [degrees/s]
  std::string follow;            // the body or collider that the camera moves along with; empty: none
  Ease ease = Ease::smooth;
  std::vector<CameraKey> keys;  // in order of time
  double shutter_deg = 0;       // how much of a frame the shutter is open, of 360; 0: for an instant
  double aperture = 0;          // diameter of the lens; 0: all is sharp [m]
  // The body or collider of this name is sharp, or what is at this distance along the direction of the view [m];
  // without both, the target is.
  std::string focus_on;
  std::optional<double> focus_distance;

  bool moves() const { return orbit_deg != 0 || !keys.empty(); }
  // Tells whether the scene says where the camera stands, so that nothing else decides what is in the picture.
  bool is_placed() const { return position || target || distance || !follow.empty() || !keys.empty(); }
};

// Names what is seen behind the bodies.
enum class BackdropKind { ground, plain, transparent, shadows };
template <>
struct Names<BackdropKind> {
  static constexpr std::array table = {Name{BackdropKind::ground, "ground"}, Name{BackdropKind::plain, "plain"},
                                       Name{BackdropKind::transparent, "transparent"},
                                       Name{BackdropKind::shadows, "shadows"}};
};

// Tells whether pictures before a backdrop have coverage.
constexpr bool is_transparent(BackdropKind kind) {
  return kind == BackdropKind::transparent || kind == BackdropKind::shadows;
}

// Names sets of lamps (render/light_rig.h).
enum class LightKind { studio, sunset, overcast, dark };
template <>
struct Names<LightKind> {
  static constexpr std::array table = {Name{LightKind::studio, "studio"}, Name{LightKind::sunset, "sunset"},
                                       Name{LightKind::overcast, "overcast"}, Name{LightKind::dark, "dark"}};
};

struct LookDef {
  LightKind light = LightKind::studio;
  BackdropKind backdrop = BackdropKind::ground;
  Vec3 ground = Vec3(0.914, 0.894, 0.863);      // sRGB
  Vec3 background = Vec3(0.851, 0.871, 0.902);  // sRGB
  double exposure = 1;
  bool show_labels = true;      // captions are drawn
  bool supports = true;         // what holds the bodies is seen
  std::filesystem::path ghost;  // folder of a run whose bodies are seen through these; empty: none
  bool marks = false;           // where handles hold vertices, and where vertices touch colliders
  bool wireframe = false;       // bodies are drawn as their elements, with the elements' edges
};

// Names the field that the surfaces of bodies show.
enum class FieldQuantity { none, stretch, compression, volume, energy, stress, speed, depth, force, distance };
template <>
struct Names<FieldQuantity> {
  static constexpr std::array table = {Name{FieldQuantity::none, "none"},
                                       Name{FieldQuantity::stretch, "stretch"},
                                       Name{FieldQuantity::compression, "compression"},
                                       Name{FieldQuantity::volume, "volume"},
                                       Name{FieldQuantity::energy, "energy"},
                                       Name{FieldQuantity::stress, "stress"},
                                       Name{FieldQuantity::speed, "speed"},
                                       Name{FieldQuantity::depth, "depth"},
                                       Name{FieldQuantity::force, "force"},
                                       Name{FieldQuantity::distance, "distance"}};
};

// Names how the range of a field is found where no numbers are given.
enum class FieldRange {
  usual,  // from the quantity and the bodies (film/pictures/surface_field.h)
  film,   // from the whole film, which only a drawing from saved motion knows
};
template <>
struct Names<FieldRange> {
  static constexpr std::array table = {Name{FieldRange::usual, "usual"}, Name{FieldRange::film, "film"}};
};

// Names the colours of a field.
enum class FieldColors { usual, viridis, blue_yellow, blue_orange };
template <>
struct Names<FieldColors> {
  static constexpr std::array table = {Name{FieldColors::usual, "usual"}, Name{FieldColors::viridis, "viridis"},
                                       Name{FieldColors::blue_yellow, "blue-yellow"},
                                       Name{FieldColors::blue_orange, "blue-orange"}};
};

struct FieldDef {
  FieldQuantity quantity = FieldQuantity::none;
  FieldRange range_by = FieldRange::usual;
  std::optional<Eigen::Vector2d> range;  // low and high, in the quantity's unit
  FieldColors colors = FieldColors::usual;
  bool legend = true;
  std::filesystem::path reference;  // folder of the run to which distances are measured
};

// Holds a line of text that pictures show from one time of the film to another. The picture of a frame shows it when
// the frame's time t has from < t <= to: a player that shows the frames one after the other shows it from `from` to
// `to`.
struct Subtitle {
  double from = 0, to = 0;  // [s]
  std::string text;         // in UTF-8; a newline begins another line
  FilePlace place;          // in the scene or in its file of subtitles
};

// Chooses what pictures say in words; each part can be switched.
struct TextDef {
  std::string font;  // family of the letters; empty: the usual one
  FilePlace font_place;
  // The title and the time stand in the upper left corner.
  bool title = false, time = false;
  // These numbers stand below the caption of each body, and tell of its steps in the frame.
  bool method = false, milliseconds = false, iterations = false, error = false;
  bool notes() const { return method || milliseconds || iterations || error; }
  // These are small graphs over the film so far, in a corner.
  bool error_graph = false, time_graph = false;
  // These stand at the lower edge, in order of their begin.
  std::vector<Subtitle> subtitles;
  std::optional<SourceFile> subtitle_file;  // from which some of them are
};

struct OutputDef {
  int width = 1280;
  int height = 720;
  double aspect = 0;                     // width over height for which the camera was placed; 0: those of the pictures
  int samples = 4;                       // of antialiasing, a pixel
  int blur_samples = 0;                  // pictures that one with blur is the mean of; 0: as many as the blur asks for
  bool energy = false;                   // whether kinetic, elastic and gravitational energy are computed each frame
  std::vector<PicturePass> passes = {};  // pictures in numbers beside those of the film, in ascending order
};

// Names the frame of an earlier run with whose end a film begins.
struct EarlierFrame {
  std::filesystem::path run;    // the folder of the run
  int frame = 0;                // of the run
  std::optional<double> clock;  // time at the end of that frame; nothing: (frame + 1) / fps of this film [s]
  FilePlace place;
};

struct SceneDef {
  std::string name;   // of the file, without folder and ending
  std::string title;  // shown in pictures where text.title asks for it
  int frames = 120;
  FrameRate fps = 30;
  int substeps = 1;
  Vec3 gravity = Vec3(0, -9.81, 0);
  std::uint64_t seed = 1;            // of random start states, and of gusts
  std::optional<EarlierFrame> from;  // nothing: the film begins at time 0, as the scene says
  std::optional<Wind> wind;          // nothing: there is no air
  std::vector<BodyDef> bodies;
  std::vector<ColliderDef> colliders;
  CameraDef camera;
  LookDef look;
  FieldDef field;
  TextDef text;
  OutputDef output;
  std::size_t sweep_points = 0;  // points of the [sweep] table (sweep.h), which a scene that is run alone ignores
  std::filesystem::path assets;

  double time_step() const { return 1 / (fps * substeps); }
  // Returns how many frames, of this film's rate, the clock has behind it when the film begins. Frames of the film are
  // counted from 0.
  int frames_before() const {
    if (!from) return 0;
    return from->clock ? static_cast<int>(std::lround(*from->clock * fps)) : from->frame + 1;
  }
  // Returns the time at which the film begins [s].
  double time_at_start() const { return fps.time_of(frames_before()); }
  // Returns the time after the steps of a frame [s], which its picture shows: its caption, the contact sheet, the run's
  // page, tables and files all tell it. A film begins with bodies that no picture shows; without `from`, frame 0 is at
  // 1 / fps.
  double time_after(int frame) const { return fps.time_of(frames_before() + frame + 1LL); }
  // Tells whether there is anything that a body may touch, besides itself. Runs keep contact forces where there is.
  bool may_touch() const { return !colliders.empty() || bodies.size() > 1; }
};

}  // namespace supple
