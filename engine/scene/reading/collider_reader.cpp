// Reads the colliders.
#include "base/text.h"
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
  collider.thickness = table.number(
      {"thickness", "m", "of a layer around the shape that already pushes, so that drawn surfaces stay apart"}, 0.0,
      Range::at_least(0));
  collider.ease = read_ease(table);
  collider.keys = read_keys(table, "rotation about the shape's origin: x, then y, then z");
  collider.visible = table.boolean({"visible", "", "drawn in the film"}, true);
  collider.color = table.color_if_given({"color", "sRGB", "over the shape's own; cool grey without either"});
  return collider;
}

}  // namespace supple
