#include "scene/body_mesh.h"

#include "base/hash.h"
#include "geometry/mesh_bytes.h"
#include "geometry/mesh_file.h"
#include "geometry/surface_file.h"
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

TetMesh tetrahedra(const Shape& shape, int vertices, const std::string& source, const Making& making) {
  return tetrahedralize(shape, vertices, source, [&](int attempt, double share) {
    if (making.tell)
      making.tell(
          fmt::format("meshing {} with {} vertices: attempt {}, {:.0f} %", source, vertices, attempt, 100 * share));
  });
}

// make_shape: called only where the mesh has not been kept.
template <class MakeShape>
TetMesh kept_tetrahedra(const Loaded& loaded, int vertices, const Making& making, const MakeShape& make_shape) {
  return kept_or_made(making.cache, fmt::format("mesh of {} vertices from {}", vertices, content_name(loaded.files)),
                      tet_mesh_from, [&] { return tetrahedra(make_shape(), vertices, loaded.source, making); });
}

Loaded loaded_surface(const BodyDef& def, const Making& making) {
  Loaded loaded;
  loaded.source = def.surface.string();
  loaded.skin = read_closed_surface(def.surface, &loaded.notes);
  loaded.files = {source_of(def.surface, loaded.skin)};
  loaded.regions = Shape{}.regions;
  loaded.mesh = kept_tetrahedra(loaded, def.vertices, making, [&] { return shape_of(loaded.skin); });
  return loaded;
}

Loaded loaded_shape(const SceneDef& scene, const BodyDef& def, const Making& making) {
  Loaded loaded;
  loaded.source = def.shape.string();
  loaded.shape = load_shape(def.shape, scene.assets);
  loaded.regions = loaded.shape.regions;
  loaded.notes = loaded.shape.notes;
  loaded.files = loaded.shape.files;
  loaded.mesh = kept_tetrahedra(loaded, def.vertices, making, [&]() -> const Shape& { return loaded.shape; });
  return loaded;
}

// Converts the element references of a file to the tags 0, 1, ... Reference 0 denotes the part of the body without a
// tag.
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

std::string content_name(const std::vector<SourceFile>& files) {
  std::string name;
  for (const SourceFile& file : files) name += (name.empty() ? "" : " ") + hash_text_form(file.hash);
  return name;
}

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
    loaded = def.surface.empty() ? loaded_shape(scene, def, making_) : loaded_surface(def, making_);
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
