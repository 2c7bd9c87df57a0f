#include "scene/building/skin_report.h"

#include <fmt/core.h>

#include <utility>

#include "geometry/skins/skin_stretch.h"

namespace supple {
namespace {

// A part of a skin that is further from its elements than this many of their edges is about as thick as an element: it
// follows the elements, and does not bend by itself.
constexpr double far_outside = 1;

}  // namespace

std::string skin_words(const Body& body, const DrawnBody& drawn) {
  if (!drawn.vertex_of.empty()) return "";
  const OutsideShare outside = outside_share(drawn.embedding);
  if (outside.share == 0) return "within its elements";
  return outside.furthest <= far_outside * mean_edge(body.description.mesh) ? "close to its elements"
                                                                            : "in places far from its elements";
}

std::string skin_text(const Body& body, const DrawnBody& drawn) {
  if (!drawn.vertex_of.empty()) return "";
  const OutsideShare outside = outside_share(drawn.embedding);
  std::string text = fmt::format("{} vertices", drawn.skin.rest.points.rows());
  if (outside.share == 0) return text + ", all in elements";
  return text + fmt::format(", {:.0f} % outside the elements, by up to {:.2g} m ({:.2g} of an element's edge)",
                            100 * outside.share, outside.furthest, outside.furthest / mean_edge(body.description.mesh));
}

std::optional<Warning> skin_warning(const Body& body, const DrawnBody& drawn) {
  if (!drawn.vertex_of.empty()) return std::nullopt;
  const OutsideShare outside = outside_share(drawn.embedding);
  const double edges = outside.furthest / mean_edge(body.description.mesh);
  if (edges <= far_outside) return std::nullopt;
  const Vec3 at = drawn.skin.rest.points.row(outside.furthest_point);
  std::string message = fmt::format(
      "the skin of body '{}' reaches {:.2g} m beyond its elements at ({:.3g}, {:.3g}, {:.3g}), {:.1f} times an "
      "element's "
      "edge: what is there follows and does not bend; more vertices (now {}) fill it",
      body.def.name, outside.furthest, at.x(), at.y(), at.z(), edges, body.def.vertices);
  return Warning{WarningKind::skin, {body.def.place, std::move(message)}, is_meant(body.def, WarningKind::skin)};
}

}  // namespace supple
