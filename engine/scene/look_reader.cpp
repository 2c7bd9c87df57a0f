#include "scene/look_reader.h"

namespace supple {

LookDef read_look(const ConfigTable& root, LookDef look) {
  const auto table = root.table({"look", "", "ground, background and light"});
  if (!table) return look;
  look.ground = table->vector({"ground", "sRGB", "colour of the ground"}, look.ground, Range::between(0, 1));
  look.background = table->vector({"background", "sRGB", "colour that the ground fades into"}, look.background,
                                  Range::between(0, 1));
  look.exposure = table->number({"exposure", "", "multiplies the light"}, look.exposure, Range::above(0, 100));
  look.show_labels = table->boolean({"labels", "", "captions below the bodies"}, look.show_labels);
  look.wireframe =
      table->boolean({"wireframe", "", "bodies are drawn as their elements, with the elements' edges"}, look.wireframe);
  return look;
}

FieldDef read_field(const ConfigTable& root) {
  FieldDef field;
  const auto table = root.table({"field", "", "a quantity that the bodies' surfaces show in colours"});
  if (!table) return field;
  field.quantity = table->word<FieldQuantity>({"quantity", "", "what the colours mean"}, FieldQuantity::none);
  const auto range = table->word_or_pair({"range", "of the quantity", "values of the first and the last colour"},
                                         "usual", {all_names<FieldRange>()}, Range::any());
  if (const auto* numbers = std::get_if<Eigen::Vector2d>(&range)) {
    field.range = *numbers;
    if (numbers->x() >= numbers->y()) table->complain("range", "range: the first number must be below the second");
  } else {
    field.range_by = *value_named<FieldRange>(std::get<std::string>(range));
  }
  field.colors = table->word<FieldColors>({"colors", "", "of the low and the high end"}, FieldColors::usual);
  field.legend = table->boolean({"legend", "", "a bar that tells the colours' values"}, field.legend);
  field.reference = table->text({"reference", "", "folder of the run to which distances are measured"}, "");
  if (field.quantity == FieldQuantity::distance && field.reference.empty())
    table->complain("quantity", "quantity: distance needs a reference, the folder of the run to measure to");
  if (field.quantity != FieldQuantity::distance && !field.reference.empty())
    table->complain("reference", "reference: is used by quantity = \"distance\" alone");
  return field;
}

}  // namespace supple
