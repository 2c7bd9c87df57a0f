#include "scene/body_mesh.h"

#include "geometry/mesh_file.h"
#include "geometry/tetrahedralize.h"
#include "scene/shape_reader.h"

namespace supple {
namespace {

Loaded loaded_cloth(const ClothDef& def) {
  Loaded loaded;
  loaded.cloth = def.mesh.empty() ? cloth_grid(def.extent, def.cells) : cloth_of(read_surface(def.mesh));
  if (!def.mesh.empty()) loaded.files = {source_of(def.mesh, loaded.cloth.surface)};
  loaded.mesh.rest = loaded.cloth.surface.points;
  loaded.mesh.tets.resize(0, 4);
  loaded.source =
      def.mesh.empty() ? fmt::format("a grid of {} x {}", def.cells.x() + 1, def.cells.y() + 1) : def.mesh.string();
  return loaded;
}

Loaded loaded_box(const BoxDef& def) {
  Loaded loaded;
  loaded.mesh = box_mesh(def.extent, def.cells);
  loaded.regions = {""};
  loaded.source = fmt::format("a box of {} x {} x {} cells", def.cells.x(), def.cells.y(), def.cells.z());
  return loaded;
}

// Turns the element references of a file into the tags 0, 1, ... Reference 0 is the body without a tag.
void name_references(Loaded& loaded) {
  std::map<int, int> tag = {{0, 0}};
  loaded.regions = {""};
  for (int& region : loaded.mesh.regions) {
    const auto [at, added] = tag.try_emplace(region, static_cast<int>(loaded.regions.size()));
    if (added) loaded.regions.push_back(fmt::format("{}", region));
    region = at->second;
  }
}

}  // namespace

const Loaded& MeshCache::get(const SceneDef& scene, const BodyDef& def) {
  std::string key = !def.mesh.empty() ? def.mesh.string()
                                      : fmt::format("{}{}#{}", def.shape.string(), def.surface.string(), def.vertices);
  if (def.box || def.cloth) key = "body " + def.name;
  const auto known = loaded_.find(key);
  if (known != loaded_.end()) return known->second;
  Loaded loaded;
  if (def.cloth) {
    loaded = loaded_cloth(*def.cloth);
  } else if (def.box) {
    loaded = loaded_box(*def.box);
  } else if (def.mesh.empty()) {
    loaded.source = def.surface.empty() ? def.shape.string() : def.surface.string();
    const Shape shape = def.surface.empty() ? load_shape(def.shape, scene.assets) : load_surface(def.surface);
    loaded.mesh = tetrahedralize(shape, def.vertices, loaded.source);
    loaded.regions = shape.regions;
    loaded.notes = shape.notes;
    loaded.files = shape.files;
    if (!def.surface.empty())
      loaded.skin = std::get<ClosedSurface>(shape.root.parts.front().primitive).solid->surface();
  } else {
    loaded.source = def.mesh.string();
    MeshFile file = read_mesh(def.mesh);
    loaded.files = {source_of(def.mesh, file.mesh)};
    loaded.mesh = std::move(file.mesh);
    loaded.notes = std::move(file.notes);
    name_references(loaded);
  }
  return loaded_.emplace(key, std::move(loaded)).first->second;
}

}  // namespace supple
