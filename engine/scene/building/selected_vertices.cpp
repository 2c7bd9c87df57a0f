#include "scene/building/selected_vertices.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/text.h"
#include "geometry/skins/surface_colors.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

std::vector<std::int32_t> numbered_vertices(const Selection& s, const TetMesh& mesh) {
  std::vector<std::int32_t> result;
  for (const int number : s.vertices) {
    if (number <= mesh.rest.rows()) result.push_back(number - 1);
  }
  return result;
}

std::vector<std::int32_t> vertices_of_region(const Selection& s, const Body& body) {
  const TetMesh& mesh = body.description.mesh;
  const auto tag = std::find(body.regions.begin(), body.regions.end(), s.region) - body.regions.begin();
  std::vector<std::int32_t> result;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    if (mesh.regions[e] != tag) continue;
    for (int k = 0; k < 4; ++k) result.push_back(mesh.tets(e, k));
  }
  return result;
}

std::vector<std::int32_t> nearest_vertices(const Selection& s, const Bounds& box, const Positions& points) {
  std::vector<std::int32_t> result;
  for (const Vec3& relative : s.points) {
    const Vec3 at = box.lower + relative.cwiseProduct(box.extent());
    Eigen::Index nearest = 0;
    (points.rowwise() - at.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    result.push_back(static_cast<std::int32_t>(nearest));
  }
  return result;
}

// Returns the vertices in a box, ball or half space.
std::vector<std::int32_t> vertices_within(const Selection& s, const Bounds& box, const Positions& points) {
  const Vec3 extent = box.extent().cwiseMax(1e-300);
  std::vector<std::int32_t> result;
  for (std::int32_t v = 0; v < points.rows(); ++v) {
    const Vec3 point = points.row(v);
    const Vec3 relative = (point - box.lower).cwiseQuotient(extent);
    const Vec3 away = point - (box.lower + s.center.cwiseProduct(extent));
    bool in = false;
    // The box has a tolerance of a millionth, because a box that ends at 1 is meant to include vertices at 1.
    if (s.kind == Selection::Kind::box)
      in = (relative.array() >= s.lower.array() - 1e-6).all() && (relative.array() <= s.upper.array() + 1e-6).all();
    if (s.kind == Selection::Kind::sphere) in = away.norm() <= s.radius * box.extent().maxCoeff();
    if (s.kind == Selection::Kind::plane) in = away.dot(s.normal.normalized()) >= -1e-6 * box.extent().maxCoeff();
    if (in) result.push_back(v);
  }
  return result;
}

// Tells which vertices of a cloth are on its open border.
std::vector<char> on_border(const Triangles& triangles, Eigen::Index vertices) {
  std::map<VertexPair, int> count;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      VertexPair edge{triangles(t, k), triangles(t, (k + 1) % 3)};
      std::sort(edge.begin(), edge.end());
      ++count[edge];
    }
  }
  std::vector<char> border(std::size_t(vertices), 0);
  for (const auto& [edge, triangles_there] : count) {
    if (triangles_there == 1) border[std::size_t(edge[0])] = border[std::size_t(edge[1])] = 1;
  }
  return border;
}

// Names a place on the file's surface, and the vertex of the mesh that has the properties of this place.
struct ToldPlace {
  std::int32_t vertex;
  Eigen::Index triangle;
  Vec3 weights;
};

// Returns the corners of a cloth; of a solid, the places of what is drawn that are nearest to the vertices on its
// surface.
std::vector<ToldPlace> told_places(const Body& body) {
  std::vector<ToldPlace> places;
  if (body.def.cloth) {
    const Triangles& triangles = body.cloth.surface.triangles;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t)
      for (int k = 0; k < 3; ++k) places.push_back({triangles(t, k), t, Vec3::Unit(k)});
    return places;
  }
  const TriangleSoup skin(body.skin);
  const double far = 10 * (bounds_of(body.skin.points).diagonal() + bounds_of(body.unplaced).diagonal());
  const Triangles faces = boundary_faces(body.description.mesh.tets);
  for (const std::int32_t v : std::set<std::int32_t>(faces.data(), faces.data() + faces.size())) {
    const TriangleSoup::Near near = skin.closest(body.unplaced.row(v).transpose(), far, Vec3::Zero());
    if (near.triangle < 0) continue;
    const auto corner = [&](int k) -> Vec3 { return body.skin.points.row(body.skin.triangles(near.triangle, k)); };
    places.push_back({v, near.triangle, weights_in_triangle(near.point, corner(0), corner(1), corner(2))});
  }
  return places;
}

std::vector<std::int32_t> vertices_of_group(const Selection& s, const Body& body) {
  std::vector<std::int32_t> result;
  if (!body.parts) return result;
  std::vector<char> named;
  for (const std::vector<std::string>& names : body.parts->names)
    named.push_back(std::ranges::find(names, s.group) == names.end() ? 0 : 1);
  if (std::ranges::find(named, 1) == named.end()) return result;
  for (const ToldPlace& place : told_places(body))
    if (named[std::size_t(body.parts->of[std::size_t(place.triangle)])] != 0) result.push_back(place.vertex);
  return result;
}

// Returns how far a colour is from the wanted one, in the channel in which it is furthest.
double off(const Selection& s, const Body& body, const ToldPlace& place) {
  return (srgb_at(*body.file_colors, place.triangle, place.weights) - s.color).cwiseAbs().maxCoeff();
}

std::vector<std::int32_t> vertices_of_color(const Selection& s, const Body& body) {
  std::vector<std::int32_t> result;
  if (!body.file_colors) return result;
  for (const ToldPlace& place : told_places(body))
    if (off(s, body, place) <= s.tolerance + 1e-9) result.push_back(place.vertex);
  return result;
}

// Returns how bright a mask is at a place; below 0 where the place has no texture coordinates.
double brightness(const Selection& s, const Body& body, const ToldPlace& place) {
  const auto& corners = (*body.places)[std::size_t(place.triangle)];
  const Eigen::Vector2d at =
      place.weights[0] * corners[0] + place.weights[1] * corners[1] + place.weights[2] * corners[2];
  return at.allFinite() ? brightness_at(*s.picture, at) : -1;
}

std::vector<std::int32_t> vertices_of_mask(const Selection& s, const Body& body) {
  std::vector<std::int32_t> result;
  if (!body.places || !s.picture) return result;
  for (const ToldPlace& place : told_places(body))
    if (brightness(s, body, place) > s.above) result.push_back(place.vertex);
  return result;
}

std::vector<std::int32_t> vertices_of_kind(const Selection& s, const Body& body) {
  using Kind = Selection::Kind;
  const Bounds box = bounds_of(body.unplaced);
  switch (s.kind) {
    case Kind::vertices: return numbered_vertices(s, body.description.mesh);
    case Kind::region: return vertices_of_region(s, body);
    case Kind::nearest: return nearest_vertices(s, box, body.unplaced);
    case Kind::group: return vertices_of_group(s, body);
    case Kind::color: return vertices_of_color(s, body);
    case Kind::mask: return vertices_of_mask(s, body);
    case Kind::box:
    case Kind::sphere:
    case Kind::plane: break;
  }
  return vertices_within(s, box, body.unplaced);
}

std::string group_reason(const Selection& s, const Body& body) {
  if (!body.parts) return ": it is not made of a file that names groups, objects or materials";
  std::vector<std::string> names;
  for (const std::vector<std::string>& of_part : body.parts->names)
    names.insert(names.end(), of_part.begin(), of_part.end());
  if (std::ranges::find(names, s.group) == names.end())
    return fmt::format(": its file names nothing '{}'{}; it names {}", s.group, did_you_mean(s.group, names),
                       name_list(names));
  return fmt::format(": '{}' is so small that no vertex of its elements has it nearest", s.group);
}

std::string color_reason(const Selection& s, const Body& body) {
  const std::vector<ToldPlace> places = body.file_colors ? told_places(body) : std::vector<ToldPlace>();
  if (places.empty()) return ": it is not made of a file that has colours";
  const auto nearest =
      std::ranges::min_element(places, {}, [&](const ToldPlace& place) { return off(s, body, place); });
  const Vec3 there = 255 * srgb_at(*body.file_colors, nearest->triangle, nearest->weights);
  return fmt::format(": the nearest colour at its vertices is \"#{:02x}{:02x}{:02x}\", which tolerance = {:.2f} takes",
                     std::lround(there.x()), std::lround(there.y()), std::lround(there.z()),
                     std::ceil(100 * off(s, body, *nearest)) / 100);
}

std::string mask_reason(const Selection& s, const Body& body) {
  double brightest = -1;
  if (body.places)
    for (const ToldPlace& place : told_places(body)) brightest = std::max(brightest, brightness(s, body, place));
  if (brightest < 0) return ": it is not made of a surface's file that has texture coordinates, on which a mask lies";
  return fmt::format(": at its texture coordinates '{}' is {:.2f} bright at most; above = {:g} asks for more",
                     s.mask.filename().string(), brightest, s.above);
}

}  // namespace

std::string empty_reason(const Selection& s, const Body& body) {
  if (s.border && !vertices_of_kind(s, body).empty()) {
    const std::vector<char> border = on_border(body.cloth.surface.triangles, body.description.mesh.rest.rows());
    return std::ranges::find(border, 1) == border.end() ? ": a border is where a cloth ends, and there is none"
                                                        : ": nothing that it selects is on the border of the cloth";
  }
  if (s.kind == Selection::Kind::region) return fmt::format(": there is no region '{}'", s.region);
  if (s.kind == Selection::Kind::group) return group_reason(s, body);
  if (s.kind == Selection::Kind::color) return color_reason(s, body);
  if (s.kind == Selection::Kind::mask) return mask_reason(s, body);
  return "; boxes, spheres and planes are relative to the rest bounding box (0 to 1)";
}

std::vector<std::int32_t> selected_vertices(const Selection& s, const Body& body) {
  std::vector<std::int32_t> result = vertices_of_kind(s, body);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  if (s.border) {
    const std::vector<char> border = on_border(body.cloth.surface.triangles, body.description.mesh.rest.rows());
    std::erase_if(result, [&](std::int32_t v) { return border[std::size_t(v)] == 0; });
  }
  return result;
}

}  // namespace supple
