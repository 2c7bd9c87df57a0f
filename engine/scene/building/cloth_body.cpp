#include "scene/building/cloth_body.h"

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "geometry/files/mesh_file.h"
#include "geometry/files/surface_file.h"
#include "geometry/skins/file_corners.h"
#include "geometry/skins/surface_colors.h"
#include "geometry/triangles/remesh.h"
#include "geometry/triangles/sewn_border.h"
#include "geometry/triangles/welded_surface.h"
#include "scene/building/cloth_cut.h"

namespace supple {
namespace {

double sheet_area(const TriMesh& surface) {
  double area = 0;
  for (const double share : vertex_areas(surface)) area += share;
  return area;
}

// Returns how many metres a unit of a surface is on the finished body.
double metres_of_unit(const TriMesh& surface, const BodyDef& def) {
  return def.size ? *def.size / bounds_of(surface.points).extent().maxCoeff() : def.scale;
}

// Makes triangles whose edges have the wanted length. edge: this length in the world, where the body has its size [m];
// lines: edges of the surface that stay as lines.
RemeshedSurface with_edges_of(const TriMesh& surface, const std::vector<std::array<std::int32_t, 2>>& lines,
                              double edge, const BodyDef& def, Body& body) {
  const double scale = metres_of_unit(surface, def);
  // What needs more triangles than this is refused before it is made.
  constexpr double most_triangles = 1e6;
  const double longest = scale * bounds_of(surface.points).extent().maxCoeff(),
               area = scale * scale * sheet_area(surface);
  if (edge > longest / 4)
    throw InputError({{def.place, fmt::format("edge = {:g} m is too long for a surface of {:.3g} m: at most a quarter",
                                              edge, longest)}});
  const double triangles = area / (std::sqrt(3.0) / 4 * edge * edge);
  if (triangles > most_triangles)
    throw InputError(
        {{def.place, fmt::format("edge = {:g} m would make {:.2g} triangles of a surface of {:.3g} m^2; at "
                                 "most {:.0e}",
                                 edge, triangles, area, most_triangles)}});
  RemeshOptions options;
  options.edge_length = edge / scale;
  options.lines = lines;
  options.crease_angle = std::numbers::pi;  // fabric has no creases; borders and seams of three sheets stay
  RemeshedSurface remade = remeshed(surface, options, body.source);
  const TriMesh& made = remade.mesh;
  body.notes.push_back(fmt::format("{} triangles became {}, with edges of {:.3g} m on the average",
                                   surface.triangles.rows(), made.triangles.rows(),
                                   scale * mean_edge(made.triangles, made.points)));
  const double lost = 1 - scale * scale * sheet_area(made) / area;
  if (std::abs(lost) > 0.02)
    body.notes.push_back(
        fmt::format("its area changed by {:.2g} %: details finer than the edge are gone", -100 * lost));
  return remade;
}

// Joins vertices on the border that lie apart, as the scene asks.
void sew(const BodyDef& def, TriMesh& surface, Body& body) {
  const double scale = metres_of_unit(surface, def);
  SewnSurface sewn = sewn_border(surface, *def.cloth->sew / scale);
  surface = std::move(sewn.mesh);
  if (sewn.joined == 0) {
    body.notes.push_back(fmt::format(
        "sew = {:g} m joins nothing: {}", *def.cloth->sew,
        sewn.left == 0
            ? "it has no border"
            : fmt::format("no two of its {} border vertices are that near, except along an edge", sewn.left)));
    return;
  }
  body.notes.push_back(fmt::format(
      "{} border vertices were sewn to others, which were up to {:.2g} m apart; {}", sewn.joined, scale * sewn.furthest,
      sewn.left == 0 ? "no border remains" : fmt::format("{} border vertices remain", sewn.left)));
  if (sewn.beside > 0)
    body.notes.push_back(fmt::format(
        "{} of these lie within {:g} m of another border, but between its vertices: slits remain there, because only "
        "vertices are sewn to each other",
        sewn.beside, *def.cloth->sew));
}

// Holds the triangles of a cloth from a file, and where in the file their corners come from. `corners` is empty where
// the file gives no colours, places in a texture or names that would have to be found again.
struct FileCloth {
  TriMesh surface;
  FileCorners corners;
};

// Returns the edges that stay as lines when the triangles become new ones: seams of the texture, and borders between
// parts. Returns none, or throws for a cloth that is cut by its texture, where so many would stay that new triangles
// could not have the wanted size, as in a texture that has a place of its own for each triangle.
std::vector<std::array<std::int32_t, 2>> lines_that_stay(const BodyDef& def, const FileCloth& cloth,
                                                         const ColoredSurface& file, Body& body) {
  if (cloth.corners.empty()) return {};
  std::vector<std::array<std::int32_t, 2>> lines = file_seams(cloth.surface, cloth.corners, file);
  const Eigen::Index most = cloth.surface.triangles.rows() * 3 / 5;  // two of five edges of a closed surface
  if (std::ssize(lines) <= most) return lines;
  const std::string many = fmt::format(
      "its texture has seams, or its parts meet, along {} edges between {} triangles: too many to stay where "
      "triangles become new",
      lines.size(), cloth.surface.triangles.rows());
  if (def.cloth->cut == ClothCut::texture)
    throw InputError({{def.cloth->cut_place,
                       fmt::format("edge with cut = \"texture\": in '{}' {}; without edge the triangles are the file's",
                                   def.cloth->surface.filename().string(), many)}});
  body.notes.push_back(many + ", so that colours and names there are only near to where they were");
  return {};
}

// Puts into the body what the file says of the cloth's triangles: colours, names, texture coordinates and cut.
void keep_what_is_said(const BodyDef& def, const FileCloth& cloth, const ColoredSurface& file, Body& body) {
  if (!cloth.corners.empty()) {
    body.file_colors = colors_on(cloth.corners, file);
    body.parts = parts_on(cloth.corners, file);
    body.places = places_on(cloth.corners, file);
  }
  choose_colors(def, def.cloth->surface, body);
  if (def.cloth->cut == ClothCut::texture) body.flat = flat_cut(cloth.surface, cloth.corners, file, def, body.notes);
}

// Reads any triangles for cloth. Vertices at the same place become one, so that seams are sewn.
TriMesh surface_for_cloth(const BodyDef& def, Body& body) {
  const ClothDef& cloth = *def.cloth;
  body.source = cloth.surface.string();
  ColoredSurface file = read_colored_surface(cloth.surface);
  file.mesh = set_up(std::move(file.mesh), def.surface_options);
  const Eigen::Index triangles = file.mesh.triangles.rows();
  WeldedSurface joined = welded(file.mesh, 1e-6 * bounds_of(file.mesh.points).diagonal(), body.source);
  if (joined.mesh.triangles.rows() != triangles)
    body.notes.push_back(
        fmt::format("{} triangles without area, or repeated, were left out", triangles - joined.mesh.triangles.rows()));
  body.notes.insert(body.notes.end(), file.remarks.begin(), file.remarks.end());
  FileCloth made;
  if (!file.colors.empty() || !file.places.empty() || !file.parts.of.empty())
    made.corners = corners_in(file.mesh, joined);
  made.surface = std::move(joined.mesh);
  if (cloth.sew) sew(def, made.surface, body);
  body.files = {source_of(cloth.surface, made.surface)};
  if (cloth.edge) {
    RemeshedSurface fine = with_edges_of(made.surface, lines_that_stay(def, made, file, body), *cloth.edge, def, body);
    if (!made.corners.empty()) made.corners = corners_in(made.corners, fine);
    made.surface = std::move(fine.mesh);
  }
  keep_what_is_said(def, made, file, body);
  return std::move(made.surface);
}

TriMesh mesh_for_cloth(const BodyDef& def, Body& body) {
  body.source = def.cloth->mesh.string();
  TriMesh surface = read_surface(def.cloth->mesh);
  body.files = {source_of(def.cloth->mesh, surface)};
  return def.cloth->edge ? with_edges_of(surface, {}, *def.cloth->edge, def, body).mesh : surface;
}

}  // namespace

Body body_of_cloth(const BodyDef& def) {
  const ClothDef& cloth = *def.cloth;
  Body body;
  if (!cloth.surface.empty()) {
    body.cloth = cloth_of(surface_for_cloth(def, body));
  } else if (!cloth.mesh.empty()) {
    body.cloth = cloth_of(mesh_for_cloth(def, body));
  } else {
    body.cloth = cloth_grid(cloth.extent, cloth.cells);
    body.source = fmt::format("a grid of {} x {}", cloth.cells.x() + 1, cloth.cells.y() + 1);
  }
  body.description.mesh.rest = body.cloth.surface.points;
  body.description.mesh.tets.resize(0, 4);
  return body;
}

void choose_colors(const BodyDef& def, const std::filesystem::path& file, Body& body) {
  if (def.takes_colors_of_file()) body.colors = body.file_colors;
  // What is drawn depends on the colours; the elements do not.
  if (body.colors) body.files.push_back({"colours of " + file.filename().string(), body.colors->hash});
  if (def.colors == ColorSource::file && !body.colors)
    body.notes.emplace_back("the file has no colours (colors = \"file\"): the body's own is drawn");
}

}  // namespace supple
