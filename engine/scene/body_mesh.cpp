#include "scene/body_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/hash.h"
#include "geometry/mesh_bytes.h"
#include "geometry/mesh_file.h"
#include "geometry/surface_thickness.h"
#include "geometry/tetrahedralize.h"
#include "scene/body_pieces.h"
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

TetMesh tetrahedra(const Shape& shape, int vertices, const std::string& source, const Making& making,
                   double swell = 0) {
  const auto heard = [&](int attempt, double share) {
    if (making.tell)
      making.tell(
          fmt::format("meshing {} with {} vertices: attempt {}, {:.0f} %", source, vertices, attempt, 100 * share));
  };
  return tetrahedralize(shape, vertices, source, heard, swell);
}

std::string kept_name(const Loaded& loaded, int vertices) {
  return fmt::format("mesh of {} vertices from {}", vertices, content_name(loaded.files));
}

// Joins parts that touch without an overlap by what lies between them: their fields melt into each other there.
std::optional<Shape> bridged(const TriMesh& boundary, double gap) {
  constexpr std::size_t most_parts = 64;  // every part is asked for every distance
  Shape shape;
  for (TriMesh& mesh : closed_parts(boundary)) {
    if (!(enclosed_volume(mesh) > 0)) return std::nullopt;
    ShapePart part;
    part.primitive = ClosedSurface{std::make_shared<TriangleSolid>(std::move(mesh))};
    part.blend = shape.root.parts.empty() ? 0 : gap;
    shape.root.parts.push_back(std::move(part));
  }
  if (shape.root.parts.size() < 2 || shape.root.parts.size() > most_parts) return std::nullopt;
  return shape;
}

std::string count_text(double vertices) {
  return vertices > 500000 ? "more than 500000" : fmt::format("about {:.0f}", std::ceil(vertices / 100) * 100);
}

// Tells what of a surface is thinner than an element, before tetrahedra are made of it.
struct Thinness {
  double spacing = 0;
  double wanted = 0;      // vertices
  std::string note;       // empty where nothing is
  bool hopeless = false;  // most of it is, so that no lattice inside it holds together
};

Thinness thinness_of(const TriMesh& boundary, int vertices) {
  const double volume = enclosed_volume(boundary), area = area_of(boundary);
  if (!(volume > 0)) return {};
  Thinness result{spacing_for(volume, area, vertices), 0, ""};
  // The tree for the rays of more triangles takes longer than a reader of the note would wait.
  constexpr Eigen::Index most_triangles = 200000;
  if (boundary.triangles.rows() > most_triangles) return result;
  const std::vector<ThicknessSample> samples = sampled_thickness(boundary);
  result.wanted = vertices_wanted(samples, volume, area);
  const auto thin = std::count_if(samples.begin(), samples.end(),
                                  [&](const ThicknessSample& s) { return s.thickness < 0.7 * result.spacing; });
  const double share = double(thin) / std::max<double>(1, double(samples.size()));
  if (share < 0.05) return result;
  result.hopeless = share > 0.5;
  const Vec3& place = samples.front().place;
  result.note = fmt::format(
      "{:.1f} % of the surface belongs to parts thinner than an element of {} vertices ({:.2g}), the thinnest at "
      "({:.3g}, "
      "{:.3g}, {:.3g}), in the file's units: {} vertices resolve them",
      100 * share, vertices, result.spacing, place.x(), place.y(), place.z(), count_text(result.wanted));
  return result;
}

// Makes the body of what is near the surface, where that is too thin or hangs together too loosely for a body inside
// it. reason: why there is none inside.
TetMesh swollen_tetrahedra(const TriMesh& boundary, const BodyDef& def, const Loaded& loaded, const Thinness& thinness,
                           const std::string& reason, const Making& making) {
  const Shape shape = shape_of(boundary);
  for (const double swell : {0.5, 1.0}) {
    try {
      return tetrahedra(shape, def.vertices, loaded.source, making, swell);
    } catch (const InputError&) {  // the reason is that of the body inside
    }
  }
  throw InputError(
      loaded.source,
      fmt::format("{}{}{}; more vertices (now {}) may help, or pieces = \"largest\", or thicken = 0.01 [m], "
                  "which gives sheets a thickness",
                  reason, thinness.note.empty() ? "" : "; ", thinness.note, def.vertices));
}

// touching: whether parts are near each other without an overlap, and so may fall apart.
TetMesh surface_tetrahedra(const SolidSurface& solid, bool touching, const BodyDef& def, const Loaded& loaded,
                           const Thinness& thinness, const Making& making) {
  const TriMesh& boundary = solid.boundary;
  std::string reason = "is too thin for its elements";
  if (!thinness.hopeless) {
    try {
      return tetrahedra(shape_of(boundary), def.vertices, loaded.source, making);
    } catch (const InputError& error) {
      reason = error.problems().front().message;
    }
    try {
      const auto joined = touching ? bridged(boundary, 3 * thinness.spacing) : std::nullopt;
      if (joined) return tetrahedra(*joined, def.vertices, loaded.source, making);
    } catch (const InputError& error) {
      reason = error.problems().front().message;
    }
  }
  return swollen_tetrahedra(boundary, def, loaded, thinness, reason, making);
}

// Returns how far elements reach beyond the box of a surface.
double reach_beyond(const TetMesh& mesh, const TriMesh& boundary) {
  const Bounds own = bounds_of(mesh.rest), box = bounds_of(boundary.points);
  return std::max((box.lower - own.lower).maxCoeff(), (own.upper - box.upper).maxCoeff());
}

Loaded loaded_surface(const BodyDef& def, const Making& making) {
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
  const Thinness thinness = thinness_of(solid.boundary, def.vertices);
  if (!thinness.note.empty()) loaded.notes.push_back(thinness.note);
  loaded.mesh = kept_or_made(making.cache, kept_name(loaded, def.vertices), tet_mesh_from,
                             [&] { return surface_tetrahedra(solid, read.touching, def, loaded, thinness, making); });
  const double beyond = reach_beyond(loaded.mesh, solid.boundary);
  if (beyond > 0.1 * thinness.spacing) {
    loaded.notes.push_back(fmt::format(
        "the elements reach {:.2g} beyond the surface, in the file's units, so that they hold its thin or loose parts: "
        "it bends as what is that much thicker does, and colliders touch the elements",
        beyond));
  }
  if (def.takes_colors_of_file()) loaded.colors = read.colors[def.piece];
  // What is drawn depends on the colours, the tetrahedra above do not.
  if (loaded.colors) loaded.files.push_back({def.surface, loaded.colors->hash});
  if (def.colors == ColorSource::file && !loaded.colors)
    loaded.notes.push_back("the file has no colours (colors = \"file\"): the body's own is drawn");
  return loaded;
}

Loaded loaded_shape(const SceneDef& scene, const BodyDef& def, const Making& making) {
  Loaded loaded;
  loaded.source = def.shape.string();
  loaded.shape = load_shape(def.shape, scene.assets);
  loaded.regions = loaded.shape.regions;
  loaded.notes = loaded.shape.notes;
  loaded.files = loaded.shape.files;
  loaded.mesh = kept_or_made(making.cache, kept_name(loaded, def.vertices), tet_mesh_from,
                             [&] { return tetrahedra(loaded.shape, def.vertices, loaded.source, making); });
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
