#include "geometry/checked_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "base/read_file.h"

namespace supple {

Vec3 far_origin(const Bounds& box) {
  // A body within this many of its sizes keeps all but four bits of a float's 24.
  constexpr double near = 16;
  if (box.empty() || !(box.diagonal() > 0)) return Vec3::Zero();
  const double reach = std::max(box.lower.cwiseAbs().maxCoeff(), box.upper.cwiseAbs().maxCoeff());
  return reach > near * box.diagonal() ? box.center() : Vec3(Vec3::Zero());
}

CheckedSurface checked_surface(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  check_regular_file(file);
  const auto bytes = [&] { return read_text(file, std::uintmax_t(1) << 30); };
  if (ending == ".obj") return checked_obj(bytes(), name);
  if (ending == ".off") return checked_off(bytes(), name);
  if (ending == ".ply") return checked_ply(bytes(), name);
  if (ending == ".stl") return checked_stl(bytes(), name);
  if (ending == ".gltf" || ending == ".glb") return checked_gltf(bytes(), file);
  if (ending == ".dae") return checked_collada(bytes(), name);
  return {};
}

}  // namespace supple
