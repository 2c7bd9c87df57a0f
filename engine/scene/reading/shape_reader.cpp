#include "scene/reading/shape_reader.h"

#include <algorithm>
#include <numbers>

#include "base/hash.h"
#include "geometry/files/surface_file.h"
#include "geometry/solids/triangle_solid.h"
#include "scene/definition/rotation.h"
#include "scene/reading/known_surfaces.h"
#include "scene/reading/table_readers.h"

namespace supple {

namespace {

constexpr int deepest_group = 8;

const std::vector<std::string> primitive_names = {"sphere",   "ellipsoid", "capsule",    "round_cone", "box",
                                                  "cylinder", "torus",     "half_space", "surface",    "parts"};

const Range lengths = Range::above(0, 1e6);

ShapeGroup read_parts(const ConfigTable& table, const Key& key, Shape& shape, int depth);

double read_round(const ConfigTable& table, double largest) {
  const double round =
      table.number({"round", "m", "radius of the edges, at most half the shortest extent"}, 0.0, Range::at_least(0));
  if (round > largest)
    table.complain("round", fmt::format("round = {}: must be at most {:g}, half the shortest extent", round, largest));
  return std::min(round, largest);
}

ClosedSurface known_surface(Config& config, const std::filesystem::path& file, const SurfaceOptions& options,
                            Shape& shape) {
  const auto known = known_surfaces(config);
  const std::string name = file.string() + options.text();
  auto at = known->of_parts.find(name);
  if (at == known->of_parts.end()) {
    KnownSurfaces::Read read;
    SolidSurface solid = read_solid_surface(file, options, &read.notes);
    read.source = source_of(file, solid);
    read.options = options;
    read.surface.solid = std::make_shared<TriangleSolid>(std::move(solid.boundary));
    if (solid.drawn.triangles.rows() > 0) read.surface.drawn = std::make_shared<TriMesh>(std::move(solid.drawn));
    at = known->of_parts.emplace(name, std::move(read)).first;
  }
  shape.notes.insert(shape.notes.end(), at->second.notes.begin(), at->second.notes.end());
  shape.files.push_back(at->second.source);
  return at->second.surface;
}

// Reads how the surface of a part is taken. Beside the options that bodies have too, a part gives the size and the
// place that its surface has in the shape's frame.
SurfaceOptions read_part_surface(const ConfigTable& part) {
  SurfaceOptions options = read_surface_options(part);
  options.size =
      part.number_if_given({"size", "m", "longest side of a surface; without it the file's units count"}, lengths)
          .value_or(0);
  options.center =
      part.boolean({"center", "", "puts the middle of the bottom of a surface's box at the part's origin"}, false);
  for (const char* key : {"size", "center"}) {
    if (part.has(key) && !part.has("surface"))
      part.complain(key, fmt::format("{}: of a 'surface'; there is none here", key));
  }
  return options;
}

std::optional<Primitive> read_primitive(const ConfigTable& part, Shape& shape, int depth) {
  std::optional<Primitive> result;
  if (const auto t = part.table({"sphere", "", "a ball around the origin"})) {
    result = Sphere{t->number({"radius", "m", "radius"}, std::nullopt, lengths)};
  }
  if (const auto t = part.table({"ellipsoid", "", "a ball stretched along the axes"})) {
    result = Ellipsoid{t->vector({"radii", "m", "half axes"}, std::nullopt, lengths)};
  }
  if (const auto t = part.table({"capsule", "", "all points within a radius of a segment"})) {
    const std::vector<Vec3> ends = t->vectors({"ends", "m", "the segment's two ends"}, 2);
    const double radius = t->number({"radius", "m", "radius"}, std::nullopt, lengths);
    if (ends.size() == 2) result = Capsule{ends[0], ends[1], radius};
  }
  if (const auto t = part.table({"round_cone", "", "the hull of two balls"})) {
    const std::vector<Vec3> ends = t->vectors({"ends", "m", "the balls' centres"}, 2);
    const std::vector<double> radii = {
        t->number({"radius", "m", "the first ball's radius"}, std::nullopt, lengths),
        t->number({"end_radius", "m", "the second ball's radius"}, std::nullopt, lengths)};
    if (ends.size() == 2) result = RoundCone{ends[0], ends[1], radii[0], radii[1]};
  }
  if (const auto t = part.table({"box", "", "a box around the origin"})) {
    const Vec3 half = 0.5 * t->vector({"extent", "m", "the three edges"}, std::nullopt, lengths);
    result = Box{half, read_round(*t, half.minCoeff())};
  }
  if (const auto t = part.table({"cylinder", "", "a cylinder around the y axis"})) {
    const double radius = t->number({"radius", "m", "radius"}, std::nullopt, lengths);
    const double half = 0.5 * t->number({"height", "m", "height"}, std::nullopt, lengths);
    result = Cylinder{radius, half, read_round(*t, std::min(radius, half))};
  }
  if (const auto t = part.table({"torus", "", "a ring around the y axis"})) {
    const double radius =
        t->number({"radius", "m", "from the centre to the middle of the tube"}, std::nullopt, lengths);
    result = Torus{radius, t->number({"tube", "m", "the tube's radius"}, std::nullopt, lengths)};
  }
  if (const auto t = part.table({"half_space", "", "everything on one side of a plane"})) {
    const Vec3 normal = t->vector({"normal", "", "points out of the solid"}, std::nullopt);
    if (normal.norm() < 1e-9) t->complain("normal", "normal: must not be zero");
    result = HalfSpace{
        normal.normalized(),
        t->number({"offset", "m", "distance of the plane from the origin along the normal"}, 0.0, Range::any())};
  }
  const SurfaceOptions options = read_part_surface(part);
  if (part.has("surface")) {
    const std::filesystem::path file = part.file({"surface", "", "a triangle surface: OBJ, PLY, STL, glTF, OFF"});
    if (!file.empty()) {
      try {
        result = known_surface(part.config(), file, options, shape);
      } catch (const InputError& error) {
        for (const Problem& problem : error.problems()) part.config().complain(problem);
      }
    }
  }
  if (part.has("parts")) {
    if (depth >= deepest_group) {
      part.complain("parts", fmt::format("parts inside parts more than {} deep", deepest_group));
    } else {
      result = read_parts(part, {"parts", "", "a group: parts combined among themselves first"}, shape, depth + 1);
    }
  }
  return result;
}

// Refuses a first part that cuts or intersects: there is no solid yet to which it could be applied.
void need_solid(const ConfigTable& table, const ShapePart& first) {
  if (first.combine != Combine::add)
    table.complain("op", "op: the first part must be added; there is nothing to cut or intersect yet");
}

ShapePart read_part(const ConfigTable& table, Shape& shape, int depth) {
  ShapePart part;
  part.primitive = Sphere{1};
  std::vector<std::string> given;
  for (const std::string& name : primitive_names) {
    if (table.has(name.c_str())) given.push_back(name);
  }
  if (given.size() != 1) {
    std::string all;
    for (const std::string& name : primitive_names) all += (all.empty() ? "" : ", ") + name;
    table.complain(given.empty() ? fmt::format("a part needs one of {}", all)
                                 : fmt::format("a part is one thing, not both '{}' and '{}'", given[0], given[1]));
  }
  if (const auto primitive = read_primitive(table, shape, depth)) part.primitive = *primitive;

  const Vec3 position = table.vector({"position", "m", "where the part's origin lies"}, Vec3(0, 0, 0));
  const Vec3 turn = table.vector({"turn_deg", "degrees", "rotation about x, then y, then z"}, Vec3(0, 0, 0));
  Eigen::Isometry3d to_parent = Eigen::Isometry3d::Identity();
  to_parent.linear() = rotation_from_degrees(turn).toRotationMatrix();
  to_parent.translation() = position;
  part.to_local = to_parent.inverse();
  part.scale = table.number({"scale", "", "enlarges the part about its origin"}, 1.0, Range::above(0, 1e6));
  part.mirror_x = table.boolean({"mirror", "", "the part also stands at -x"}, false);
  part.combine = table.word<Combine>({"op", "", "how the part joins what came before"}, Combine::add);
  part.blend =
      table.number({"blend", "m", "width over which the surfaces melt into each other"}, 0.0, Range::at_least(0));
  const std::string region = table.text({"region", "", "tag of the elements inside"}, "");
  const auto known = std::find(shape.regions.begin(), shape.regions.end(), region);
  part.region = static_cast<int>(known - shape.regions.begin());
  if (known == shape.regions.end()) shape.regions.push_back(region);
  return part;
}

ShapeGroup read_parts(const ConfigTable& table, const Key& key, Shape& shape, int depth) {
  ShapeGroup group;
  for (const ConfigTable& part : table.tables(key)) {
    group.parts.push_back(read_part(part, shape, depth));
    if (group.parts.size() == 1) need_solid(part, group.parts.front());
  }
  return group;
}

Vec3 read_color(const ConfigTable& table, const Vec3& fallback) {
  return table.color({"color", "sRGB", "red, green, blue"}, fallback);
}

}  // namespace

Shape read_shape(const ConfigTable& table) {
  Shape shape;
  shape.color = read_color(table, shape.color);
  shape.root = read_parts(table, {"part", "", "combined in the order of the file"}, shape, 0);
  if (shape.root.parts.empty()) table.complain("a shape needs at least one [[part]]");
  for (const ConfigTable& layer :
       table.tables({"paint", "", "layers of colour on the drawn skin; later ones lie on top"})) {
    PaintLayer paint;
    paint.name = layer.text({"name", "", "for people"}, "");
    paint.color = read_color(layer, Vec3(0.2, 0.2, 0.2));
    paint.gloss = layer.number({"gloss", "", "0 matt to 1 wet"}, 0.2, Range::between(0, 1));
    paint.soft = layer.number({"soft", "m", "width of the layer's border"}, 0.0, Range::at_least(0));
    Shape area;  // only its parts and its files are used
    paint.area = read_parts(layer, {"part", "", "where the colour is"}, area, 0);
    shape.files.insert(shape.files.end(), area.files.begin(), area.files.end());
    shape.paint.push_back(std::move(paint));
  }
  if (shape.paint.size() > 8) table.complain("paint", fmt::format("{} layers of paint: at most 8", shape.paint.size()));
  return shape;
}

Shape read_single_part(const ConfigTable& table) {
  Shape shape;
  shape.root.parts.push_back(read_part(table, shape, 0));
  need_solid(table, shape.root.parts.front());
  return shape;
}

Shape load_shape(const std::filesystem::path& path, const std::filesystem::path& assets, Config* user) {
  Config config = Config::load(path, assets);
  if (user != nullptr) config.surfaces() = known_surfaces(*user);
  Shape shape = read_shape(config.root());
  config.finish();
  shape.files.push_back({path, hash_text(config.as_json())});
  return shape;
}

}  // namespace supple
