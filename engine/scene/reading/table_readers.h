// Reads the tables of a scene file, each into a part of a SceneDef (scene_reader.h). Problems are recorded in the
// tables' Config. Not here: tables of shapes (shape_reader.h).
#pragma once

#include "base/finish.h"
#include "base/frame_rate.h"
#include "scene/config/config.h"
#include "scene/definition/body_def.h"
#include "scene/definition/camera_def.h"
#include "scene/definition/collider_def.h"
#include "scene/definition/field_def.h"
#include "scene/definition/look_def.h"
#include "scene/definition/text_def.h"
#include "sim/model/air_inputs.h"

namespace supple {

struct EarlierFrame;

// Reads the table of a body: what it is made of, where it starts, and what holds it. defaults: the defaults of the
// body's solver, from the scene's table.
BodyDef read_body(const ConfigTable& table, const SolverDef& defaults);

// Reads how a body starts: at rest when it has no table `start`.
StartDef read_start(const ConfigTable& body);

// Reads `material` (and `fibre`) of a body or a region: a preset's name, or a table with the model and its parameters.
SubstanceDef read_substance(const ConfigTable& owner);

// Reads `material` of a body of cloth: a fabric's name, or a table with the model of the sheet and its parameters.
FabricDef read_fabric(const ConfigTable& owner);

// Returns the table that a preset stands for, { model = "neo-hookean", young = ..., poisson = ... }, and the other
// values that it sets. Empty when no preset has this name.
std::string preset_in_full(const std::string& name);

// Reads `plastic` and `creep` into a body whose material and solver are known.
void read_flow(const ConfigTable& table, BodyDef& body);

// Reads how a surface from a file is taken: its axes and units, and what is done where it is not closed. Bodies and
// parts of shapes have these keys in common; they are refused in tables without a `surface`.
SurfaceOptions read_surface_options(const ConfigTable& table);

// Reads a `solver` table, of the whole scene or of a body. Keys that are absent keep their defaults.
SolverDef read_solver(const ConfigTable& table, const SolverDef& defaults);

// Reads [wind] of a scene's root; nothing where it is absent. seed: of the gusts.
std::optional<Wind> read_wind(const ConfigTable& root, std::uint64_t seed);

// These read the tables `drag` and `pressure` of a body; nothing where they are absent.
std::optional<DragCoefficients> read_drag(const ConfigTable& body);
std::optional<GasFilling> read_pressure(const ConfigTable& body);

// Reads [from] of a scene's root; nothing where it is absent. fps: the rate of the film, which must have a frame that
// ends at `clock`.
std::optional<EarlierFrame> read_from(const ConfigTable& root, const FrameRate& fps);

ColliderDef read_collider(const ConfigTable& table);

// Reads [camera]. Problems are values that contradict each other, and keys of its way that are not in order of time.
CameraDef read_camera(const ConfigTable& table, CameraDef camera);

// These read the tables [look], [field] and [text] of a scene's root.
LookDef read_look(const ConfigTable& root, LookDef look);
FieldDef read_field(const ConfigTable& root);
TextDef read_text(const ConfigTable& root);

// Reads how the surface of a body or a collider treats light.
Finish read_finish(const ConfigTable& table);

Ease read_ease(const ConfigTable& table);

// Reads the list `keys`, in the order of time. `turn`: the meaning of the key turn_deg, for the documentation.
std::vector<MotionKey> read_keys(const ConfigTable& table, const char* turn);

}  // namespace supple
