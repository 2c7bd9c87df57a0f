// Defines what a live page may ask of a session, and reads it from the body of a request. Nothing here knows the
// scene: whether a path or a body is there is found where the command is carried out (session.h).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/names.h"
#include "base/types.h"

namespace supple {

enum class Deed {
  set,        // a value, as a replay changes it
  pause,      // the frames stop
  run,        // they go on
  step,       // one frame, then pause
  speed,      // of the film against the clock
  restart,    // the film begins again, without what was done
  go,         // back to a frame, without what was done after it
  grab,       // the vertices at a place of the picture
  drag,       // them to another place
  drop,       // them
  release,    // a handle that was left holding
  orbit,      // the camera, about its target
  pan,        // camera and target, in the plane of the picture
  zoom,       // the camera, towards its target
  home,       // the scene's own camera
  keep_view,  // the film of the replay has the page's camera
  show,       // another look of the surfaces
  keep_rate,  // steps end when their share of a frame's time is over
  save,       // the replay of what was done
};
template <>
struct Names<Deed> {
  static constexpr std::array table = {Name{Deed::set, "set"},         Name{Deed::pause, "pause"},
                                       Name{Deed::run, "run"},         Name{Deed::step, "step"},
                                       Name{Deed::speed, "speed"},     Name{Deed::restart, "restart"},
                                       Name{Deed::go, "go"},           Name{Deed::grab, "grab"},
                                       Name{Deed::drag, "drag"},       Name{Deed::drop, "drop"},
                                       Name{Deed::release, "release"}, Name{Deed::orbit, "orbit"},
                                       Name{Deed::pan, "pan"},         Name{Deed::zoom, "zoom"},
                                       Name{Deed::home, "home"},       Name{Deed::keep_view, "keep_view"},
                                       Name{Deed::show, "show"},       Name{Deed::keep_rate, "keep_rate"},
                                       Name{Deed::save, "save"}};
};

// Holds a deed, and of the other members those that it needs.
struct Command {
  Deed deed = Deed::pause;
  std::string path, value;  // of set: as --set takes them
  double over = 0;          // of set: how long it takes [s]
  double factor = 1;        // of speed and zoom
  int frame = 0;            // of go: the number of frames that stay
  // Of grab and drag: the place in the picture from its upper left corner, 0 to 1. Of orbit: azimuth and elevation
  // [degrees]. Of pan: to the right and up, over the picture's height.
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::string body, name;                // of release
  bool on = false;                       // of keep_rate; of drop: whether the handle goes on holding
  std::optional<std::string> field;      // of show: a quantity of `field`
  std::optional<bool> wireframe, marks;  // of show
};

// Reads a command from JSON: {"do": DEED, ...}, as docs/live.md lists it. Throws InputError, which names the key and
// what it may have.
Command read_command(std::string_view json);

}  // namespace supple
