#include "output/files/obj_file.h"

#include <fmt/core.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "geometry/meshes/mesh.h"
#include "output/files/whole_file.h"

namespace supple {

namespace {

constexpr const char* origin_line = "# origin {} {} {}: to be added to all vertices, here and in the point cache\n";

}  // namespace

Vec3 motion_origin(const Positions& rest) {
  const Bounds box = bounds_of(rest);
  const double size = box.diagonal();
  if (rest.rows() == 0 || rest.cwiseAbs().maxCoeff() <= 1e3 * size) return Vec3::Zero();
  const double unit = std::exp2(std::ceil(std::log2(size)));
  return unit * (box.center() / unit).array().round().matrix();
}

std::string origin_line_of_obj(const Vec3& origin) {
  return origin.isZero(0) ? "" : fmt::format(fmt::runtime(origin_line), origin.x(), origin.y(), origin.z());
}

void write_obj(const std::filesystem::path& path, const Positions& points, const Triangles& triangles,
               const Vec3& origin) {
  std::string text = origin_line_of_obj(origin);
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const Vec3 p = points.row(v).transpose() - origin;
    fmt::format_to(std::back_inserter(text), "v {:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", triangles(t, 0) + 1, triangles(t, 1) + 1,
                   triangles(t, 2) + 1);
  write_whole_file(path, text);
}

Vec3 origin_of_obj(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string sign, word;
  Vec3 origin = Vec3::Zero();
  if (file >> sign >> word && sign == "#" && word == "origin") file >> origin.x() >> origin.y() >> origin.z();
  return origin;
}

}  // namespace supple
