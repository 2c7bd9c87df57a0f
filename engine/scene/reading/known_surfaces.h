// Holds the surfaces that a Config and its copies have read already: they are read once, although a replay reads its
// scene's document again for every change.
#pragma once

#include <map>
#include <memory>

#include "geometry/shapes/shape.h"
#include "geometry/shapes/solid_motion.h"
#include "scene/config/config.h"

namespace supple {

struct BodySurface;  // body_pieces.h

struct KnownSurfaces {
  struct Read {
    ClosedSurface surface;
    std::vector<std::string> notes;
    SourceFile source;
    SurfaceOptions options = {};
  };
  struct ReadMotion {
    std::shared_ptr<const SolidMotion> motion;
    SourceFile source;
  };
  std::map<std::string, Read> of_parts;                                 // by path and options
  std::map<std::string, ReadMotion> of_motions;                         // by motion, body and surface
  std::map<std::string, std::shared_ptr<const BodySurface>> of_bodies;  // by path, options and rule for pieces
};

inline std::shared_ptr<KnownSurfaces> known_surfaces(Config& config) {
  if (!config.surfaces()) config.surfaces() = std::make_shared<KnownSurfaces>();
  return config.surfaces();
}

}  // namespace supple
