#include "scene/building/drawn_body.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/files/source_file.h"
#include "geometry/skins/flat_places.h"
#include "geometry/skins/mesh_bytes.h"
#include "geometry/skins/skin_stretch.h"
#include "geometry/triangles/refine_surface.h"
#include "scene/definition/rotation.h"

namespace supple {
namespace {

Mat3 turn_of(const Body& body) { return rotation_from_degrees(body.def.turn_deg).toRotationMatrix(); }

// Returns the edge of the printed squares [m]; 0: nothing is printed.
double square_of(const Body& body) {
  if (body.def.pattern == Pattern::none) return 0;
  if (body.def.usual_pattern && body.def.cloth && body.colors) return 0;  // the file's colours are its print
  if (body.def.pattern_size) return *body.def.pattern_size;
  Vec3 extent = bounds_of(body.description.mesh.rest * turn_of(body)).extent();
  std::sort(extent.begin(), extent.end());
  return body.def.cloth ? extent[2] / 20 : extent[1] / 6;
}

// Describes a skin in the file's frame, with the elements that carry it. Bodies that differ only in place, size and
// substance share one. number: the edge of the skin's cells for a shape, or of the printed squares for a surface [the
// file's units].
struct SkinRequest {
  const Body& body;
  double number;

  CarriedSkin make() const {
    CarriedSkin carried;
    const TetMesh mesh{body.unplaced, body.description.mesh.tets, {}};
    carried.skin = body.def.shape.empty() ? of_surface(mesh) : skin_of(body.shape, number);
    carried.embedding = embed(carried.skin.rest, mesh);
    return carried;
  }

  // Returns the skin of a surface. Its triangles are cut until they are small enough to bend where the elements do;
  // small ones stay as they are.
  Skin of_surface(const TetMesh& mesh) const {
    constexpr double edges = 1.5;             // longest edge of a triangle, over the elements' mean edge
    constexpr Eigen::Index most = 2'000'000;  // triangles
    const double longest = edges * mean_edge(mesh);
    if (body.colors) return colored_skin(body.skin, *body.colors, longest, most, number);
    const TriMesh surface = refined(body.skin, longest, most).mesh;
    std::vector<std::int32_t> vertex_of;
    return skin_of_surface(surface.points, surface.triangles, number, vertex_of);
  }

  // Returns a name that contains all on which the skin depends.
  std::string name() const {
    return fmt::format("skin {:a} over {} vertices from {}", number, body.def.vertices, content_name(body.files));
  }
};

SkinRequest request_for(const Body& body) {
  if (body.def.shape.empty()) return {body, square_of(body) / scale_of(body)};
  const Mat3 turn = rotation_from_degrees(body.def.table_turn_deg).toRotationMatrix();
  return {body, bounds_of(body.unplaced * turn.transpose()).extent().maxCoeff() / body.def.skin_cells};
}

// Gives the drawn surface of a cloth the colours of its file.
void color_cloth(const Body& body, const Triangles& surface, DrawnBody& drawn) {
  const std::vector<FlatPlace> flat = drawn.skin.flat;
  const std::vector<std::int32_t> before =
      put_on_colors(drawn.skin, {body.description.mesh.rest, surface}, *body.colors);
  std::vector<std::int32_t> vertex_of;
  for (const std::int32_t v : before) {
    vertex_of.push_back(drawn.vertex_of[std::size_t(v)]);
    drawn.skin.flat.push_back(flat[std::size_t(v)]);
  }
  drawn.vertex_of = std::move(vertex_of);
  drawn.textures = body.colors->textures;
}

// Draws the mesh's own boundary.
DrawnBody drawn_mesh(const Body& body) {
  DrawnBody drawn;
  const TetMesh& placed = body.description.mesh;
  const Triangles surface = surface_of(body);
  // The skin is made in the body's own directions, so that the print lies along its edges however the body stands.
  const double printed = square_of(body), square = body.def.cloth && printed == 0 ? 1 : printed;
  const bool is_drawn = printed > 0 || body.def.yarn.value_or(0) > 0;
  drawn.skin = skin_of_surface(placed.rest * turn_of(body), surface, square, drawn.vertex_of,
                               is_drawn ? BentPart::laid : BentPart::projected);
  if (body.def.cloth) drawn.skin.flat = flat_places(drawn.skin, drawn.vertex_of, square);
  if (printed == 0) drawn.skin.square.clear();
  if (body.def.cloth && body.colors) color_cloth(body, surface, drawn);
  for (std::size_t v = 0; v < drawn.vertex_of.size(); ++v)
    drawn.skin.rest.points.row(v) = placed.rest.row(drawn.vertex_of[v]);
  drawn.color = body.def.color.value_or(body.def.shape.empty() ? Shape{}.color : body.shape.color);
  return drawn;
}

}  // namespace

std::vector<DrawnBody> drawn_bodies(const std::vector<Body>& bodies, const SlowWork& work, DrawnAs surface) {
  std::vector<DrawnBody> result;
  std::map<std::string, CarriedSkin> skins;  // by name
  for (const Body& body : bodies) {
    DrawnBody drawn;
    if (surface == DrawnAs::elements || (body.def.surface.empty() && body.def.shape.empty())) {
      drawn = drawn_mesh(body);
    } else {
      const SkinRequest request = request_for(body);
      const std::string name = request.name();
      auto known = skins.find(name);
      if (known == skins.end()) {
        if (work.tell) work.tell(fmt::format("making the drawn skin of {}", body.source));
        known = skins.emplace(name, kept_or_made(work.cache, name, carried_skin_from, [&] { return request.make(); }))
                    .first;
      }
      drawn.skin = known->second.skin;
      drawn.embedding = known->second.embedding;
      scale_lengths(drawn.embedding, scale_of(body));
      for (Eigen::Index v = 0; v < drawn.skin.rest.points.rows(); ++v)
        drawn.skin.rest.points.row(v) = (body.placement * Vec3(drawn.skin.rest.points.row(v))).transpose();
      drawn.color = body.def.color.value_or(body.shape.color);
      drawn.layers = body.shape.paint;
      if (body.colors) drawn.textures = body.colors->textures;
    }
    drawn.subdivides = surface == DrawnAs::skin && body.def.cloth && !drawn.vertex_of.empty();
    drawn.two_sided = body.def.cloth || !std::holds_alternative<AtRest>(body.def.start);
    result.push_back(std::move(drawn));
  }
  return result;
}

}  // namespace supple
