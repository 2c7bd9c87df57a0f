// Draws rows of small shaded bodies without OpenGL, for a report's pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/types.h"

namespace supple {

// Holds a picture of panels beside each other.
class PanelPicture {
 public:
  // panels: how many; edge: width and height of each [pixels]
  PanelPicture(int panels, int edge);

  // Draws a surface into a panel, seen from the front, right and above. Triangles that are seen from behind are red:
  // there the body is inside out. view: the box that fills the panel; all outside of it is cut off. Positions that are
  // not finite leave the panel empty.
  void draw(int panel, const Positions& x, const Triangles& surface, const Bounds& view);

  // Throws RunError when the file cannot be written.
  void write(const std::filesystem::path& file) const;

 private:
  void fill(int panel, const Eigen::Vector3d corners[3], const std::uint8_t color[3]);

  int panels_, edge_;
  std::vector<std::uint8_t> rgb_;
  std::vector<float> depth_;
};

}  // namespace supple
