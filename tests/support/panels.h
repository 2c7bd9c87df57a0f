// Makes a file of two flat panels, which a scene sews, and the text of such a scene.
#pragma once

#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace supple::test {

// Writes a front panel of 12 x 8 cells and a back panel of 9 x 6 cells, each 0.4 m wide and 0.3 m high, 0.2 m apart.
inline void write_panels(const std::filesystem::path& file) {
  std::ofstream out(file);
  int first = 1;
  const auto panel = [&](double z, int wide, int high) {
    for (int j = 0; j <= high; ++j)
      for (int i = 0; i <= wide; ++i) out << fmt::format("v {} {} {}\n", 0.4 * i / wide, 0.3 * j / high, z);
    for (int j = 0; j < high; ++j) {
      for (int i = 0; i < wide; ++i) {
        const int a = first + j * (wide + 1) + i, b = a + wide + 1;
        out << fmt::format("f {} {} {}\nf {} {} {}\n", a, a + 1, b + 1, a, b + 1, b);
      }
    }
    first += (wide + 1) * (high + 1);
  };
  panel(0.2, 12, 8);
  panel(0, 9, 6);
}

// Returns a scene in which the sides of these panels are sewn. more: lines at its end.
inline std::string sewn_panels(const std::string& more = "") {
  return R"(fps = 60
substeps = 2
[[body]]
name = "bag"
position = [0, 0.5, 0]
cloth = { surface = "panels.obj", seam_time = 0.25, seams = [
  { side = [[0, 0, 1], [0, 1, 1]], onto = [[0, 0, 0], [0, 1, 0]] },
  { side = [[1, 0, 1], [1, 1, 1]], onto = [[1, 0, 0], [1, 1, 0]] },
] }
material = "cotton"
[[body.handles]]
name = "top"
select = { nearest = [[0.25, 1, 1], [0.75, 1, 1]] }
)" + more;
}

}  // namespace supple::test
