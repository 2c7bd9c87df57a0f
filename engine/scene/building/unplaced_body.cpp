#include "scene/building/unplaced_body.h"

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "geometry/files/mesh_file.h"
#include "geometry/files/surface_file.h"
#include "geometry/tetrahedra/meshing.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/remesh.h"
#include "geometry/triangles/welded_surface.h"
#include "scene/building/skin_overhang.h"
#include "scene/reading/body_pieces.h"
#include "scene/reading/shape_reader.h"

namespace supple {
namespace {

void take(Body& body, MadeMesh made) {
  body.description.mesh = std::move(made.mesh);
  body.notes.insert(body.notes.end(), made.notes.begin(), made.notes.end());
}

WantedMesh wanted_mesh(const Body& body, const BodyDef& def) {
  return {def.vertices, body.source, content_name(body.files)};
}

double sheet_area(const TriMesh& surface) {
  double area = 0;
  for (const double share : vertex_areas(surface)) area += share;
  return area;
}

// Makes triangles of the wanted size. An edge is given as it is in the world, where the body has its size.
TriMesh of_edge(const TriMesh& surface, double edge, const BodyDef& def, Body& body) {
  const double scale = def.size ? *def.size / bounds_of(surface.points).extent().maxCoeff() : def.scale;
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
  options.crease_angle = std::numbers::pi;  // fabric has no creases; borders and seams of three sheets stay
  TriMesh made = remeshed(surface, options, body.source).mesh;
  body.notes.push_back(fmt::format("{} triangles became {}, with edges of {:.3g} m on the average",
                                   surface.triangles.rows(), made.triangles.rows(),
                                   scale * mean_edge(made.triangles, made.points)));
  const double lost = 1 - scale * scale * sheet_area(made) / area;
  if (std::abs(lost) > 0.02)
    body.notes.push_back(
        fmt::format("its area changed by {:.2g} %: details finer than the edge are gone", -100 * lost));
  return made;
}

// Reads any triangles for cloth. Vertices at the same place become one, so that seams are sewn.
TriMesh surface_for_cloth(const BodyDef& def, Body& body) {
  const ClothDef& cloth = *def.cloth;
  TriMesh surface;
  if (!cloth.surface.empty()) {
    body.source = cloth.surface.string();
    TriMesh raw = set_up(read_colored_surface(cloth.surface).mesh, def.surface_options);
    const Eigen::Index triangles = raw.triangles.rows();
    surface = welded(raw, 1e-6 * bounds_of(raw.points).diagonal(), body.source).mesh;
    if (surface.triangles.rows() != triangles)
      body.notes.push_back(
          fmt::format("{} triangles without area, or repeated, were left out", triangles - surface.triangles.rows()));
    body.files = {source_of(cloth.surface, surface)};
  } else {
    body.source = cloth.mesh.string();
    surface = read_surface(cloth.mesh);
    body.files = {source_of(cloth.mesh, surface)};
  }
  return cloth.edge ? of_edge(surface, *cloth.edge, def, body) : surface;
}

Body body_of_cloth(const BodyDef& def) {
  const ClothDef& cloth = *def.cloth;
  Body body;
  if (!cloth.surface.empty() || !cloth.mesh.empty()) {
    body.cloth = cloth_of(surface_for_cloth(def, body));
  } else {
    body.cloth = cloth_grid(cloth.extent, cloth.cells);
    body.source = fmt::format("a grid of {} x {}", cloth.cells.x() + 1, cloth.cells.y() + 1);
  }
  body.description.mesh.rest = body.cloth.surface.points;
  body.description.mesh.tets.resize(0, 4);
  return body;
}

Body body_of_box(const BoxDef& def) {
  Body body;
  body.description.mesh = box_mesh(def.extent, def.cells);
  body.regions = {""};
  body.source = fmt::format("a box of {} x {} x {} cells", def.cells.x(), def.cells.y(), def.cells.z());
  return body;
}

Body body_of_surface(const BodyDef& def, const SlowWork& work) {
  Body body;
  body.source = def.surface.string();
  const BodySurface& read = *def.read_surface;
  const SolidSurface& solid = read.pieces.at(def.piece);
  if (def.piece == 0) body.notes = read.notes;
  body.skin = solid.skin();
  body.files = {read.sources[def.piece]};
  body.regions = Shape{}.regions;
  take(body, mesh_of_surface({solid, read.touching}, wanted_mesh(body, def), work));
  if (def.takes_colors_of_file()) body.colors = read.colors[def.piece];
  // The drawn skin depends on the colours; the tetrahedra above do not.
  if (body.colors) body.files.push_back({"colours of " + def.surface.filename().string(), body.colors->hash});
  if (def.colors == ColorSource::file && !body.colors)
    body.notes.push_back("the file has no colours (colors = \"file\"): the body's own is drawn");
  return body;
}

Body body_of_shape(const SceneDef& scene, const BodyDef& def, const SlowWork& work) {
  Body body;
  body.source = def.shape.string();
  body.shape = load_shape(def.shape, scene.assets);
  body.regions = body.shape.regions;
  body.notes = body.shape.notes;
  body.files = body.shape.files;
  take(body, mesh_of_shape(body.shape, wanted_mesh(body, def), work));
  return body;
}

// Converts the element references of a file to the tags 0, 1, ... Reference 0 denotes the part of the body without a
// tag.
void name_references(Body& body) {
  std::map<int, int> tag = {{0, 0}};
  body.regions = {""};
  for (int& region : body.description.mesh.regions) {
    const auto [at, added] = tag.try_emplace(region, static_cast<int>(body.regions.size()));
    if (added) body.regions.push_back(fmt::format("{}", region));
    region = at->second;
  }
}

Body body_of_mesh(const BodyDef& def) {
  Body body;
  body.source = def.mesh.string();
  MeshFile file = read_mesh(def.mesh);
  body.files = {source_of(def.mesh, file.mesh)};
  take(body, {std::move(file.mesh), std::move(file.notes)});
  name_references(body);
  return body;
}

// Returns a text that says all on which the mesh and the looks of a body depend.
std::string key_of(const BodyDef& def) {
  if (def.box || def.cloth) return "body " + def.name;
  std::string key = !def.mesh.empty() ? def.mesh.string()
                                      : fmt::format("{}{}#{}{}", def.shape.string(), def.surface.string(), def.vertices,
                                                    def.surface_options.text());
  if (!def.surface.empty())
    key += fmt::format(" {} {} {} {}", name_of(def.pieces), def.piece, name_of(def.colors), def.color.has_value());
  return key;
}

}  // namespace

Body UnplacedBodies::get(const SceneDef& scene, const BodyDef& asked) {
  BodyDef def = asked;
  if (!def.surface.empty() && !def.read_surface)
    def.read_surface = std::make_shared<const BodySurface>(read_body_surface(def));
  const std::string key = key_of(def);
  auto known = made_.find(key);
  if (known == made_.end()) {
    Body made = def.cloth             ? body_of_cloth(def)
                : def.box             ? body_of_box(*def.box)
                : !def.mesh.empty()   ? body_of_mesh(def)
                : def.surface.empty() ? body_of_shape(scene, def, work_)
                                      : body_of_surface(def, work_);
    if (scene.bodies.size() > 1) made.description.overhang = skin_overhang(made);
    known = made_.emplace(key, std::move(made)).first;
  }
  Body body = known->second;
  body.def = std::move(def);
  body.description.name = body.def.name;
  return body;
}

}  // namespace supple
