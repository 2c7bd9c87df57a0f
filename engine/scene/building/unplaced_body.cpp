#include "scene/building/unplaced_body.h"

#include "base/error.h"
#include "geometry/files/mesh_file.h"
#include "geometry/tetrahedra/meshing.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "scene/building/cloth_body.h"
#include "scene/building/skin_overhang.h"
#include "scene/definition/scene_def.h"
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
  body.parts = read.parts[def.piece];
  body.places = read.places[def.piece];
  body.file_colors = read.colors[def.piece];
  choose_colors(def, def.surface, body);
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
    key += fmt::format(" {} {} {} {} {} {}", name_of(def.pieces), def.piece, name_of(def.colors), def.color.has_value(),
                       def.read_surface->parts[def.piece] != nullptr, def.read_surface->places[def.piece] != nullptr);
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
