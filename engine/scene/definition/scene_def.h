// Defines a scene as its file describes it: plain nested structs with defaults, in SI units, with angles in degrees
// where the name says so. Each table of the file has a header beside this one (body_def.h, camera_def.h, ...). The
// defaults are those of the file format, except for values that a file must give and defaults that depend on other
// keys: the readers set those. Nothing is built yet (assemble.h), and nothing here depends on scene files or TOML
// (scene_reader.h).
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/frame_rate.h"
#include "scene/definition/body_def.h"
#include "scene/definition/camera_def.h"
#include "scene/definition/collider_def.h"
#include "scene/definition/field_def.h"
#include "scene/definition/look_def.h"
#include "scene/definition/output_def.h"
#include "scene/definition/text_def.h"
#include "sim/model/air_inputs.h"

namespace supple {

// Names the frame of an earlier run at whose end a film begins.
struct EarlierFrame {
  std::filesystem::path run;    // the folder of the run
  int frame = 0;                // number of the frame in the run
  std::optional<double> clock;  // time at the end of that frame; nothing: (frame + 1) / fps of this film [s]
  FilePlace place;
};

struct SceneDef {
  std::string name;   // name of the file, without folder and ending
  std::string title;  // shown in pictures where text.title asks for it
  int frames = 120;
  FrameRate fps = 30;
  int substeps = 1;
  Vec3 gravity = Vec3(0, -9.81, 0);
  std::uint64_t seed = 1;            // seed of random start states and of gusts
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
  // Returns how many frames at this film's rate have passed on the clock when the film begins. Frames of the film are
  // counted from 0.
  int frames_before() const {
    if (!from) return 0;
    return from->clock ? static_cast<int>(std::lround(*from->clock * fps)) : from->frame + 1;
  }
  // Returns the time at which the film begins [s].
  double time_at_start() const { return fps.time_of(frames_before()); }
  // Returns the time after the steps of a frame [s], which its picture shows: its headline, the contact sheet, the
  // run's page, tables and files all tell it. A film begins with bodies that no picture shows; without `from`, frame 0
  // is at 1 / fps.
  double time_after(int frame) const { return fps.time_of(frames_before() + frame + 1LL); }
  // Tells whether there is anything that a body may touch, besides itself. Runs keep contact forces where there is.
  bool may_touch() const { return !colliders.empty() || bodies.size() > 1; }
};

}  // namespace supple
