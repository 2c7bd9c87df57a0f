// Defines a body as a scene describes it: its mesh, place, material, start, handles and looks. What is made of it is a
// Body (building/body.h).
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/error.h"
#include "base/finish.h"
#include "base/names.h"
#include "base/types.h"
#include "geometry/skins/pattern.h"
#include "geometry/solids/solid_surface.h"
#include "scene/definition/cloth_def.h"
#include "scene/definition/handle_def.h"
#include "scene/definition/solver_def.h"
#include "scene/definition/start_state.h"
#include "scene/definition/warning_kinds.h"
#include "sim/materials/fibre.h"
#include "sim/materials/flow_rules.h"
#include "sim/materials/material.h"
#include "sim/model/air_inputs.h"

namespace supple {

// Describes the material of a body or of one of its regions.
struct SubstanceDef {
  Material material = Polynomial{1};
  Fibre fibre;                          // fibres, with their direction in the frame of the mesh or shape
  std::optional<double> usual_density;  // density of a preset [kg/m^3]
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

// Says what a body meets, and with which friction (meeting.h), how it bounces off bodies and colliders, and whether its
// skin touches colliders. Not here: how contact with colliders is computed (the table solver.contact), and a collider's
// own friction.
struct BodyContactDef {
  // The names of the only bodies that the body meets: none where the list is empty. Nothing: it meets all.
  std::optional<std::vector<std::string>> meets;
  FilePlace meets_place;   // place of `meets`, for messages once all bodies are known
  bool self = true;        // whether it touches itself
  bool skin = false;       // whether the drawn skin touches colliders in the stead of the elements
  double friction = 0.5;   // its share of the coefficient of Coulomb's law between it and another body
  double restitution = 0;  // the share of its speed that it keeps at least when it bounces off a collider or a body
};

struct BodySurface;  // body_pieces.h

struct BodyDef {
  std::string name;
  std::string table;  // name of the body's table in paths, which pieces of a surface and scattered copies share
  std::string label;  // the caption in pictures; empty: there is none
  std::vector<WarningKind> meant;  // warnings that need not be said
  // One of these five members gives the mesh. The regions of a mesh file are named by their reference numbers.
  std::filesystem::path shape;
  std::filesystem::path surface;
  SurfaceOptions surface_options;
  Pieces pieces = Pieces::join;                     // which pieces of the surface become bodies
  std::shared_ptr<const BodySurface> read_surface;  // what was read of `surface`; null: nothing yet
  std::size_t piece = 0;                            // number of the surface's piece that is this body
  std::filesystem::path mesh;
  std::optional<BoxDef> box;
  std::optional<ClothDef> cloth;
  int vertices = 0;               // number of vertices of elements made from a shape or surface
  std::optional<double> size;     // longest side; nothing: the file's units are metres, times `scale` [m]
  double scale = 1;               // used where no size is given
  Vec3 position = Vec3(0, 0, 0);  // of the middle of the bounding box's bottom [m]
  Vec3 turn_deg = Vec3(0, 0, 0);
  Vec3 table_turn_deg = Vec3(0, 0, 0);  // the table's own turn, without a copy's random one; skins are made for it
  std::optional<double> density;        // [kg/m^3]; of cloth [kg/m^2]
  std::optional<double> total_mass;     // spread over the volume, or over the area of cloth [kg]
  SubstanceDef substance;               // of solids
  std::optional<Plasticity> plastic;    // nothing: it keeps no dents
  std::optional<Creep> creep;           // nothing: it does not creep
  StartDef start;
  StartInside start_inside = StartInside::move;
  Vec3 velocity = Vec3(0, 0, 0);         // at the start [m/s]
  Vec3 spin_deg = Vec3(0, 0, 0);         // at the start, about the centre of mass [degrees/s]
  std::optional<DragCoefficients> drag;  // nothing: the usual drag on cloth, and none on solids
  std::optional<GasFilling> pressure;    // gas in its surface; nothing: none
  FilePlace pressure_place;              // place of `pressure`, for messages once the surface is known
  BodyContactDef contact;
  std::vector<RegionDef> regions;
  std::vector<HandleDef> handles;
  SolverDef solver;
  Pattern pattern = Pattern::none;
  bool usual_pattern = false;          // whether the scene names no pattern; cloth with colours of a file then has none
  std::optional<double> pattern_size;  // edge of the pattern's squares [m]
  std::optional<Vec3> color;           // replaces the shape's own colours [sRGB]
  std::optional<Vec3> back_color;      // colour of the back of cloth [sRGB]
  std::optional<double> yarn;          // distance between two yarns of cloth; 0: none are drawn [m]
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

}  // namespace supple
