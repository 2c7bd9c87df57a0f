#include "scene/building/body_mesh.h"

#include <cmath>

#include "base/error.h"
#include "base/hash.h"
#include "geometry/files/mesh_file.h"
#include "geometry/skins/mesh_bytes.h"
#include "geometry/tetrahedra/surface_tetrahedra.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "scene/reading/body_pieces.h"
#include "scene/reading/shape_reader.h"

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

std::string kept_name(const Loaded& loaded, const BodyDef& def) {
  return fmt::format("mesh of {} vertices from {}", def.vertices, content_name(loaded.files));
}

Loaded loaded_surface(const BodyDef& def, const SlowWork& work) {
  Loaded loaded;
  loaded.source = def.surface.string();
  BodySurface own;
  if (!def.read_surface) own = read_body_surface(def);
  const BodySurface& read = def.read_surface ? *def.read_surface : own;
  const SolidSurface& solid = read.pieces.at(def.piece);
  if (def.piece == 0) loaded.notes = read.notes;
  loaded.skin = solid.skin();
  loaded.files = {read.sources[def.piece]};
  if (read.pieces.size() > 1) loaded.whole = read.whole;
  loaded.regions = Shape{}.regions;
  const SurfaceBody body{solid, read.touching, def.vertices, loaded.source};
  SurfaceMesh made = kept_or_made(work.cache, kept_name(loaded, def), surface_mesh_from,
                                  [&] { return surface_tetrahedra(body, work); });
  loaded.mesh = std::move(made.mesh);
  loaded.notes.insert(loaded.notes.end(), made.notes.begin(), made.notes.end());
  if (def.takes_colors_of_file()) loaded.colors = read.colors[def.piece];
  // The drawn skin depends on the colours; the tetrahedra above do not.
  if (loaded.colors) loaded.files.push_back({def.surface, loaded.colors->hash});
  if (def.colors == ColorSource::file && !loaded.colors)
    loaded.notes.push_back("the file has no colours (colors = \"file\"): the body's own is drawn");
  return loaded;
}

Loaded loaded_shape(const SceneDef& scene, const BodyDef& def, const SlowWork& work) {
  Loaded loaded;
  loaded.source = def.shape.string();
  loaded.shape = load_shape(def.shape, scene.assets);
  loaded.regions = loaded.shape.regions;
  loaded.notes = loaded.shape.notes;
  loaded.files = loaded.shape.files;
  loaded.mesh = kept_or_made(work.cache, kept_name(loaded, def), tet_mesh_from,
                             [&] { return shape_tetrahedra(loaded.shape, def.vertices, loaded.source, work); });
  const auto made = double(loaded.mesh.rest.rows());
  if (std::abs(made / def.vertices - 1) > usual_miss)
    loaded.notes.push_back(
        fmt::format("has {} vertices, the nearest number to {} of which a mesh was found", made, def.vertices));
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
                                      : fmt::format("{}{}#{}{}", def.shape.string(), def.surface.string(), def.vertices,
                                                    def.surface_options.text());
  if (!def.surface.empty())
    key += fmt::format(" {} {} {} {}", name_of(def.pieces), def.piece, name_of(def.colors), def.color.has_value());
  if (def.box || def.cloth) key = "body " + def.name;
  const auto known = loaded_.find(key);
  if (known != loaded_.end()) return known->second;
  Loaded loaded;
  if (def.cloth) {
    loaded = loaded_cloth(*def.cloth);
  } else if (def.box) {
    loaded = loaded_box(*def.box);
  } else if (def.mesh.empty()) {
    loaded = def.surface.empty() ? loaded_shape(scene, def, work_) : loaded_surface(def, work_);
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
