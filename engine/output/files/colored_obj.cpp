#include "output/files/colored_obj.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "output/files/obj_file.h"
#include "output/files/png_file.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

double srgb_of(float linear) {
  const double c = std::clamp<double>(linear, 0, 1);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

void write_materials(const std::filesystem::path& path, const std::vector<Texture>& textures) {
  std::string text = "newmtl plain\nKd 1 1 1\n";
  for (std::size_t t = 0; t < textures.size(); ++t) {
    const std::string picture = fmt::format("{}-{}.png", path.stem().string(), t);
    write_png(path.parent_path() / picture, textures[t].width, textures[t].height, textures[t].rgb);
    fmt::format_to(std::back_inserter(text), "newmtl texture_{}\nKd 1 1 1\nmap_Kd {}\n", t, picture);
  }
  write_whole_file(std::filesystem::path(path).replace_extension(".mtl"), text);
}

}  // namespace

void write_colored_obj(const std::filesystem::path& path, const ColoredObj& surface) {
  const std::vector<Texture> none;
  const std::vector<Texture>& textures = surface.textures != nullptr ? *surface.textures : none;
  if (!textures.empty()) write_materials(path, textures);
  std::string text = origin_line_of_obj(surface.origin);
  const auto out = std::back_inserter(text);
  if (!textures.empty()) fmt::format_to(out, "mtllib {}.mtl\n", path.stem().string());
  for (Eigen::Index v = 0; v < surface.points.rows(); ++v) {
    const Vec3 p = surface.points.row(v).transpose() - surface.origin;
    const SurfaceColor& color = surface.colors[std::size_t(v)];
    fmt::format_to(out, "v {:.9g} {:.9g} {:.9g} {:.4g} {:.4g} {:.4g}\n", p.x(), p.y(), p.z(), srgb_of(color.red),
                   srgb_of(color.green), srgb_of(color.blue));
  }
  if (!textures.empty())
    for (const SurfaceColor& color : surface.colors) fmt::format_to(out, "vt {:.9g} {:.9g}\n", color.u, color.v);
  std::int32_t material = -2;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corner = [&](int k) { return surface.triangles(t, k) + 1; };
    const std::int32_t own = surface.colors[std::size_t(surface.triangles(t, 0))].texture;
    if (textures.empty()) {
      fmt::format_to(out, "f {} {} {}\n", corner(0), corner(1), corner(2));
      continue;
    }
    if (own != material) text += own < 0 ? "usemtl plain\n" : fmt::format("usemtl texture_{}\n", own);
    material = own;
    fmt::format_to(out, "f {0}/{0} {1}/{1} {2}/{2}\n", corner(0), corner(1), corner(2));
  }
  write_whole_file(path, text);
}

}  // namespace supple
