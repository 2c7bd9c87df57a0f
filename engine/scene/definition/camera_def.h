// Defines the camera as a scene describes it. Not here: where it stands at a time (film/pictures/camera.h).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/names.h"
#include "base/types.h"
#include "scene/definition/keyed_motion.h"

namespace supple {

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
  automatic,  // as `film` where a rough first pass finds that bodies leave the picture; else as `start`
  start,      // the bodies where they start, and the ground below those that will fall
  film,       // the bodies' whole motion, which a rough first pass finds; for drawings the run knows it
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
  double margin = 1.25;          // how much wider the picture is than what is framed; 1: no air around it
  bool has_usual_margin = true;  // whether the scene gives none: then it is margin_of_motion around a whole motion
  double orbit_deg = 0;          // how fast the eye goes round the target [degrees/s]
  std::string follow;            // the body or collider that the camera moves along with; empty: none
  Ease ease = Ease::smooth;
  std::vector<CameraKey> keys;  // in order of time
  double shutter_deg = 0;       // share of a frame for which the shutter is open, times 360; 0: for an instant
  double aperture = 0;          // diameter of the lens; 0: all is sharp [m]
  // The body or collider of this name is sharp, or what is at this distance along the direction of the view [m];
  // without both, the target is.
  std::string focus_on;
  std::optional<double> focus_distance;

  bool moves() const { return orbit_deg != 0 || !keys.empty(); }
  // Tells whether the scene says where the camera stands, so that nothing else decides what is in the picture.
  bool is_placed() const { return position || target || distance || !follow.empty() || !keys.empty(); }
};

}  // namespace supple
