// Appends vertices to a skin in the middle between two others, with the means of what these have.
#pragma once

#include <map>
#include <utility>

#include "geometry/skins/skin.h"

namespace supple {

class SkinMiddles {
 public:
  explicit SkinMiddles(Skin& skin);

  // Appends all that the skin has of a vertex between a and b, except its place. Vertices between the same two normals
  // share one normal (Skin::smooth), as copies of a and of b do.
  void append(std::size_t a, std::size_t b);

 private:
  Skin& skin_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> smooth_;  // by the numbers in Skin::smooth of the ends
  std::int32_t next_smooth_;
};

}  // namespace supple
