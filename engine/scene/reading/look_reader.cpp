// Reads what is seen beside the bodies and the camera: the tables [look], [field] and [text].
#include "scene/reading/table_readers.h"

namespace supple {

LookDef read_look(const ConfigTable& root, LookDef look) {
  const auto table = root.table({"look", "", "ground, background and light"});
  if (!table) return look;
  look.backdrop = table->word<BackdropKind>(
      {"backdrop", "",
       "a ground with shadows, the colour of the background alone, exactly as asked for, or pictures with coverage: "
       "of the bodies, or of the bodies and the shadows on the ground"},
      look.backdrop);
  look.ground = table->color({"ground", "sRGB", "colour of the ground"}, look.ground);
  look.background = table->color({"background", "sRGB", "colour that the ground fades into"}, look.background);
  look.light =
      table->word<LightKind>({"light", "", "the lamps, and the tint that they give ground and background"}, look.light);
  look.exposure = table->number({"exposure", "", "multiplies the light"}, look.exposure, Range::above(0, 100));
  look.show_labels = table->boolean({"labels", "", "the bodies' captions are drawn"}, look.show_labels);
  look.supports =
      table->boolean({"supports", "", "plates, rings, rods and pins where handles hold bodies"}, look.supports);
  look.ghost = table->text({"ghost", "", "folder of a run whose bodies are seen beside these, half transparent"}, "");
  look.marks = table->boolean(
      {"marks", "", "squares where handles hold vertices, discs where vertices touch colliders"}, look.marks);
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

TextDef read_text(const ConfigTable& root) {
  TextDef text;
  const auto table = root.table({"text", "", "what the pictures say in words"});
  if (!table) return text;
  text.title = table->boolean({"title", "", "the scene's title, in the upper left corner"}, text.title);
  text.time = table->boolean({"time", "", "the film's time, in the same line"}, text.time);
  text.method = table->boolean({"method", "", "below each body: the solver's method"}, text.method);
  text.milliseconds =
      table->boolean({"milliseconds", "", "below each body: what its steps of the frame took"}, text.milliseconds);
  text.iterations = table->boolean({"iterations", "", "below each body: how many they made"}, text.iterations);
  text.error = table->boolean(
      {"error", "", "below each body: both errors where they are measured, otherwise their estimates"}, text.error);
  text.error_graph = table->boolean({"error_graph", "",
                                     "in a corner: the larger of the two error estimates, of the body where it is "
                                     "largest, frame by frame, and measured errors as dots"},
                                    text.error_graph);
  text.time_graph = table->boolean(
      {"time_graph", "", "in a corner: what the steps of each frame took; in drawings from saved motion alone"},
      text.time_graph);
  return text;
}

}  // namespace supple
