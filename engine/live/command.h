// Defines what a live page may ask of a session, and reads it from the body of a request. Nothing here knows the
// scene: whether a path or a body is there is found where the command is carried out (session.h).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/names.h"
#include "base/types.h"

namespace supple {

enum class CommandKind {
  set,        // changes a value, as a replay does
  pause,      // stops the frames
  run,        // lets them continue
  step,       // makes one frame, and then pauses
  speed,      // sets the film's speed against the clock
  restart,    // begins the film again, without what was done
  go,         // goes back to a frame, without what was done after it
  grab,       // takes hold of the vertices at a place of the picture
  drag,       // moves what is grabbed to another place
  drop,       // lets go of what is grabbed, or leaves its handle holding it
  release,    // lets a handle go that was left holding
  orbit,      // turns the camera about its target
  pan,        // moves camera and target in the plane of the picture
  zoom,       // moves the camera towards its target
  home,       // returns to the scene's own camera
  keep_view,  // gives the film of the replay the page's camera
  show,       // gives the surfaces another look
  keep_rate,  // lets steps end when their share of a frame's time is over
  save,       // asks for the replay of what was done
};
template <>
struct Names<CommandKind> {
  static constexpr std::array table = {Name{CommandKind::set, "set"},         Name{CommandKind::pause, "pause"},
                                       Name{CommandKind::run, "run"},         Name{CommandKind::step, "step"},
                                       Name{CommandKind::speed, "speed"},     Name{CommandKind::restart, "restart"},
                                       Name{CommandKind::go, "go"},           Name{CommandKind::grab, "grab"},
                                       Name{CommandKind::drag, "drag"},       Name{CommandKind::drop, "drop"},
                                       Name{CommandKind::release, "release"}, Name{CommandKind::orbit, "orbit"},
                                       Name{CommandKind::pan, "pan"},         Name{CommandKind::zoom, "zoom"},
                                       Name{CommandKind::home, "home"},       Name{CommandKind::keep_view, "keep_view"},
                                       Name{CommandKind::show, "show"},       Name{CommandKind::keep_rate, "keep_rate"},
                                       Name{CommandKind::save, "save"}};
};

// Holds what is asked for. Of the members after `kind`, only those that this kind of command needs have values.
struct Command {
  CommandKind kind = CommandKind::pause;
  std::string path, value;  // of set: as --set takes them
  double over = 0;          // of set: how long it takes [s]
  double factor = 1;        // of speed and zoom
  int frame = 0;            // of go: the number of frames that stay
  // For grab and drag, this is the place in the picture, counted from its upper left corner, 0 to 1. For orbit, it
  // holds the change of azimuth and elevation [degrees]. For pan, it tells how far the scene moves to the right and up,
  // over the picture's height.
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
