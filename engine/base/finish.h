// Describes how a surface, of a body or a collider, treats light besides its colour.
#pragma once

#include <optional>

namespace supple {

struct Finish {
  std::optional<double> roughness;  // 0 wet to 1 chalk; nothing: the surface's gloss decides
  double translucent = 0;           // share of the light that thin parts let through, 0 to 1
  bool operator==(const Finish&) const = default;
};

}  // namespace supple
