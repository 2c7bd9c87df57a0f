#include "scene/building/thin_bodies.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/triangles/surface_thickness.h"

namespace supple {
namespace {

constexpr double slender = 5;  // length over thickness from which on a body mostly bends

// Tells of a slender box with one or two cells across. Linear tetrahedra shear where they should bend: the tip of a
// clamped bar with 1, 2 and 4 cells across sank by 2.95, 6.1 and 8.6 mm where beam theory has 10, so such a bar is 1 +
// 2.5 / cells^2 times as stiff as it should be.
std::string text_of_box(const Body& body) {
  const Vec3& extent = body.def.box->extent;
  Eigen::Index thinnest = 0;
  const double thickness = extent.minCoeff(&thinnest);
  const int cells = body.def.box->cells[thinnest];
  if (cells >= 3 || extent.maxCoeff() < slender * thickness) return "";
  return fmt::format(
      "body '{}' is {} across where it is thin: it bends as if it were {:.1f} times as stiff; three or more cells "
      "there help",
      body.def.name, cells == 1 ? "one cell" : "two cells", 1 + 2.5 / (cells * cells));
}

// Holds what share of a mesh's volume is in elements at its surface.
struct Layers {
  double inner = 0;  // share in elements without a vertex on the surface: there are three or more across
  double outer = 0;  // share in elements with all vertices on the surface, as where one is across
};

Layers layers_of(const TetMesh& mesh, const Triangles& surface) {
  std::vector<char> on_surface(std::size_t(mesh.rest.rows()), 0);
  for (Eigen::Index t = 0; t < surface.size(); ++t) on_surface[surface.data()[t]] = 1;
  Layers layers;
  double volume = 0;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    int outer = 0;
    for (int k = 0; k < 4; ++k) outer += on_surface[mesh.tets(e, k)];
    const double own = tet_volume(mesh, e);
    volume += own;
    layers.inner += outer == 0 ? own : 0;
    layers.outer += outer == 4 ? own : 0;
  }
  return {layers.inner / volume, layers.outer / volume};
}

// Returns the median thickness of a body, by the area of its surface.
double middle_thickness(const TriMesh& boundary) {
  std::vector<ThicknessSample> samples = sampled_thickness(boundary);
  return samples.empty() ? HUGE_VAL : samples[samples.size() / 2].thickness;
}

}  // namespace

std::string thinness_text(const Body& body) {
  constexpr double some = 0.02, nearly_all = 0.95;
  if (body.def.cloth) return "";
  if (body.def.box) return text_of_box(body);
  const TetMesh& mesh = body.description.mesh;
  const Triangles surface = surface_of(body);
  const Layers layers = layers_of(mesh, surface);
  if (layers.inner > some) return "";
  const Eigen::RowVector3d center = bounds_of(mesh.rest).center().transpose();
  const double length = 2 * std::sqrt((mesh.rest.rowwise() - center).rowwise().squaredNorm().maxCoeff());
  const double thickness = middle_thickness({mesh.rest, surface});
  if (length < slender * thickness) return "";
  return fmt::format(
      "body '{}' is {} across where it is thin ({:.2g} m): it bends less than it should; a mesh of smaller elements "
      "helps",
      body.def.name, layers.outer > nearly_all ? "one element" : "two elements", thickness);
}

}  // namespace supple
