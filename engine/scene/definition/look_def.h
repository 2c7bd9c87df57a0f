// Defines the look of pictures as a scene describes it: lamps, what is behind the bodies, what is drawn beside them.
#pragma once

#include <array>
#include <filesystem>

#include "base/names.h"
#include "base/types.h"

namespace supple {

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
  bool show_labels = true;      // whether captions are drawn
  bool supports = true;         // whether plates, rings, rods and pins show what holds the bodies
  std::filesystem::path ghost;  // folder of a run whose bodies are seen through these; empty: none
  bool marks = false;           // whether marks show where handles hold vertices, and where vertices touch colliders
  bool wireframe = false;       // whether bodies are drawn as their elements, with the elements' edges
};

}  // namespace supple
