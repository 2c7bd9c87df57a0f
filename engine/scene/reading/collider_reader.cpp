// Reads the colliders.
#include "base/text.h"
#include "scene/reading/known_surfaces.h"
#include "scene/reading/shape_reader.h"
#include "scene/reading/table_readers.h"

namespace supple {
namespace {

// Reads a shape: the name of a shape file, or a table that is one part as in shape files.
Shape read_collider_shape(const ConfigTable& table) {
  const Key key = {"shape", "", "a shape file, or a part as in one, such as { sphere = { radius = 0.5 } }"};
  Shape ball;
  ball.root.parts.push_back({Sphere{1}});
  if (table.is_text("shape")) {
    const std::filesystem::path file = table.file(key);
    if (file.empty()) return ball;
    try {
      return load_shape(file, table.config().assets(), &table.config());
    } catch (const InputError& error) {
      for (const Problem& problem : error.problems()) table.config().complain(problem);
      return ball;
    }
  }
  if (const auto part = table.table(key, "required")) return read_single_part(*part);
  if (!table.has("shape")) table.complain("a collider needs a 'shape', such as shape = { sphere = { radius = 0.5 } }");
  return ball;
}

// Returns the surface file of which a shape consists; null where the shape is anything else.
const KnownSurfaces::Read* lone_surface_of(const Shape& shape, const KnownSurfaces& known) {
  if (shape.root.parts.size() != 1 || shape.root.parts.front().mirror_x) return nullptr;
  const auto* surface = std::get_if<ClosedSurface>(&shape.root.parts.front().primitive);
  for (const auto& [name, read] : known.of_parts)
    if (surface != nullptr && read.surface.solid == surface->solid) return &read;
  return nullptr;
}

void read_motion_file(const ConfigTable& table, const std::filesystem::path& path, const std::string& body,
                      Shape& shape, SurfaceMotionDef& def) {
  const auto known = known_surfaces(table.config());
  const KnownSurfaces::Read* surface = lone_surface_of(shape, *known);
  if (surface == nullptr)
    return table.complain(
        "motion: of a collider whose shape is one surface file, such as { surface = \"walker.obj\" }");
  const std::filesystem::path& file = surface->source.path;
  const std::string of = body.empty() ? file.stem().string() : body;
  const std::string name = fmt::format("{} of {} on {}{}", path.string(), of, file.string(), surface->options.text());
  auto at = known->of_motions.find(name);
  if (at == known->of_motions.end()) {
    const VertexMotion motion = read_vertex_motion(path, of);
    const std::string read = motion.file.string();
    at = known->of_motions
             .emplace(name, KnownSurfaces::ReadMotion{std::make_shared<SolidMotion>(surface->surface, file,
                                                                                    surface->options, motion, read),
                                                      source_of(motion)})
             .first;
  }
  shape.files.push_back(at->second.source);
  def.motion = at->second.motion;
}

std::optional<SurfaceMotionDef> read_surface_motion(const ConfigTable& table, Shape& shape) {
  const auto motion = table.table({"motion", "", "deforms the shape, which is one surface file"});
  if (!motion) return std::nullopt;
  SurfaceMotionDef def;
  const std::filesystem::path path = motion->file_that({"file", "", motion_kinds}, is_motion_there);
  const std::string body = motion->text(
      {"body", "", "whose motion is taken from the folder of a run; without it the one that the surface's file names"},
      "");
  def.fps = motion->number_if_given({"fps", "1/s", "frames of the motion a second; without it the scene's"},
                                    Range::between(1e-3, 100000));
  def.start =
      motion->number({"start", "s", "when frame 'first' is there; until then the shape stays"}, 0.0, Range::any());
  def.first =
      motion->integer({"first", "", "the frame, counted from 0, with which the motion starts"}, 0, Range::at_least(0));
  if (path.empty()) {
    if (!motion->has("file")) motion->complain(fmt::format("a motion needs a 'file': {}", motion_kinds));
    return std::nullopt;
  }
  try {
    read_motion_file(*motion, path, body, shape, def);
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems()) table.config().complain(problem);
    return std::nullopt;
  }
  if (def.motion && def.first >= def.motion->frames())
    motion->complain("first", fmt::format("first = {}: must be below {}, the number of its frames", def.first,
                                          def.motion->frames()));
  return def.motion ? std::optional(def) : std::nullopt;
}

}  // namespace

ColliderDef read_collider(const ConfigTable& table) {
  ColliderDef collider;
  collider.place = table.place(nullptr);
  collider.name = table.text({"name", "", "addresses the collider in --set and in reports"}, "collider");
  if (collider.name.empty() || collider.name.find_first_of("./\\ ,\"") != std::string::npos ||
      printable(collider.name) != collider.name)
    table.complain("name", fmt::format("name = '{}': must be a word without spaces, dots, commas, quotes and slashes",
                                       collider.name));
  collider.shape = read_collider_shape(table);
  collider.position = table.vector({"position", "m", "of the shape's origin"}, Vec3(0, 0, 0));
  collider.turn_deg = table.vector({"turn_deg", "degrees", "rotation about x, then y, then z"}, Vec3(0, 0, 0));
  collider.friction = table.number({"friction", "", "Coulomb's coefficient"}, 0.0, Range::between(0, 100));
  collider.restitution =
      table.number({"restitution", "", "share of its speed that a body keeps at least when it bounces off"}, 0.0,
                   Range::between(0, 1));
  collider.thickness = table.number(
      {"thickness", "m", "of a layer around the shape that already pushes, so that drawn surfaces stay apart"}, 0.0,
      Range::at_least(0));
  collider.ease = read_ease(table);
  collider.motion = read_surface_motion(table, collider.shape);
  collider.keys = read_keys(table, "rotation about the shape's origin: x, then y, then z");
  collider.visible = table.boolean({"visible", "", "drawn in the film"}, true);
  collider.color = table.color_if_given({"color", "sRGB", "over the shape's own; cool grey without either"});
  collider.finish = read_finish(table);
  return collider;
}

}  // namespace supple
