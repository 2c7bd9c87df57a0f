#include "output/obj_file.h"

#include <fmt/core.h>

#include <iterator>

#include "output/whole_file.h"

namespace supple {

void write_obj(const std::filesystem::path& path, const Positions& points, const Triangles& triangles) {
  std::string text;
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    fmt::format_to(std::back_inserter(text), "v {:.9g} {:.9g} {:.9g}\n", points(v, 0), points(v, 1), points(v, 2));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", triangles(t, 0) + 1, triangles(t, 1) + 1,
                   triangles(t, 2) + 1);
  write_whole_file(path, text);
}

}  // namespace supple
