// Reads what is seen beside the bodies and the camera: the tables [look], [field] and [text].
#include <algorithm>

#include "base/hash.h"
#include "base/read_file.h"
#include "scene/reading/srt_file.h"
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

namespace {

Subtitle read_subtitle(const ConfigTable& row) {
  Subtitle subtitle;
  subtitle.from = row.number({"from", "s", "when it begins, in the film's time"}, std::nullopt, Range::at_least(0));
  subtitle.to = row.number({"to", "s", "when it ends"}, std::nullopt, Range::at_least(0));
  subtitle.text = row.text({"text", "", "what it says; a newline begins another line"}, std::nullopt);
  subtitle.place = row.place("text");
  if (row.has("from") && row.has("to") && subtitle.from >= subtitle.to)
    row.complain("to", fmt::format("to = {:g}: must be after it begins, at {:g}", subtitle.to, subtitle.from));
  std::string one_line = subtitle.text;
  std::ranges::replace(one_line, '\n', ' ');
  if (const std::string fault = subtitle_fault(one_line); !fault.empty()) row.complain("text", "text: " + fault);
  if (row.has("text") && one_line.find_first_not_of(' ') == std::string::npos)
    row.complain("text", "text: must not be empty");
  return subtitle;
}

// Appends the subtitles of a file. What is wrong in it is a problem at its own line.
void add_subtitle_file(const ConfigTable& table, const std::filesystem::path& file, TextDef& text) {
  constexpr std::uintmax_t largest = 1'000'000;  // the same bound as for a scene's file
  try {
    const std::string content = read_text(file, largest);
    for (Subtitle& one : read_srt(content, file.string())) text.subtitles.push_back(std::move(one));
    text.subtitle_file = SourceFile{file, hash_bytes(content.data(), content.size())};
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems()) table.config().complain(problem);
  }
}

}  // namespace

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
  text.font = table->text(
      {"font", "", "family of the letters, such as \"DejaVu Serif\"; without it a usual one, Lato if it is installed"},
      "");
  text.font_place = table->place("font");
  for (const ConfigTable& row : table->tables(
           {"subtitles", "", "lines in the middle of the lower edge, each from one time of the film to another"}))
    text.subtitles.push_back(read_subtitle(row));
  if (const std::filesystem::path file =
          table->file({"subtitle_file", "", "subtitles beside those, from a file in the format .srt"});
      !file.empty())
    add_subtitle_file(*table, file, text);
  std::ranges::stable_sort(text.subtitles, {}, &Subtitle::from);
  return text;
}

}  // namespace supple
