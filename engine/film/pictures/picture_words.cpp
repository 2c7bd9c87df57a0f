#include "film/pictures/picture_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "render/code_points.h"
#include "render/font_search.h"
#include "render/text_bitmap.h"

namespace supple {
namespace {

// Holds words that pictures show, and the place in the file that they are from.
struct ShownWords {
  std::string words, what;
  FilePlace place;
};

// Appends the words of a scene as it is at one time. The title stands on the contact sheet in any case.
void add_words(const SceneDef& scene, std::vector<ShownWords>& list) {
  list.push_back({scene.title, "the title", {"title"}});
  for (const BodyDef& body : scene.bodies)
    if (scene.look.show_labels) list.push_back({body.label, fmt::format("the caption of '{}'", body.name), body.place});
  for (const Subtitle& one : scene.text.subtitles)
    list.push_back({one.text, fmt::format("the subtitle at {:g} s", one.from), one.place});
}

std::vector<ShownWords> words_of(const Script& script) {
  std::vector<ShownWords> list;
  add_words(script.scene(), list);
  const auto of_words = [](const TimedChange* change) { return change->path.ends_with(".label"); };
  for (int frame = 0; frame < script.scene().frames; ++frame)
    if (std::ranges::any_of(script.at_work(frame), of_words)) add_words(script.scene_at(frame), list);
  return list;
}

void add(std::string& line, const std::string& word) { line += (line.empty() ? "" : ", ") + word; }

}  // namespace

std::string headline_text(const SceneDef& scene, double time) {
  std::string line;
  if (scene.text.title) line = scene.title;
  if (scene.text.time) line += fmt::format("{}t = {:.2f} s", line.empty() ? "" : "    ", time);
  return line;
}

std::string subtitle_text(const TextDef& text, double time) {
  std::string lines;
  for (const Subtitle& one : text.subtitles)
    if (one.from < time && time <= one.to) lines += (lines.empty() ? "" : "\n") + one.text;
  return lines;
}

std::vector<std::string> all_subtitles(const TextDef& text) {
  std::vector<double> ends;  // between two of these times, the same ones are shown
  for (const Subtitle& one : text.subtitles) ends.push_back(one.to);
  for (const Subtitle& one : text.subtitles) ends.push_back(one.from);
  std::vector<std::string> all;
  for (const double end : ends) {
    std::string lines = subtitle_text(text, end);
    if (!lines.empty() && std::ranges::find(all, lines) == all.end()) all.push_back(std::move(lines));
  }
  return all;
}

std::string longest_headline(const SceneDef& scene) {
  // Digits are about equally wide, and the last time has the most of them.
  return headline_text(scene, scene.time_after(scene.frames - 1));
}

std::string note_text(const TextDef& text, const BodyDef& body, const BodyRow* row) {
  std::string line;
  if (text.method) add(line, std::string(name_of(body.solver.method)));
  if (row == nullptr) return line;
  if (text.iterations) add(line, fmt::format("{} iterations", row->iterations));
  if (text.milliseconds) add(line, fmt::format("{:.1f} ms", row->step_ms));
  if (text.error && row->error_measured) {
    add(line, fmt::format("error {:.1e}", row->error.value_or(0)));
    if (row->motion_error) add(line, fmt::format("of motion {:.1e}", *row->motion_error));
  } else if (text.error) {
    add(line, fmt::format("error about {:.1e}", row->error_estimate));
    add(line, fmt::format("of motion about {:.1e}", row->motion_estimate));
  }
  return line;
}

std::string longest_note(const SceneDef& scene) {
  BodyRow wide;
  wide.iterations = 1000;
  wide.step_ms = 1000;
  wide.error_estimate = wide.motion_estimate = 8.8e-88;
  std::string longest;
  for (const BodyDef& body : scene.bodies) {
    const std::string note = note_text(scene.text, body, &wide);
    if (note.size() > longest.size()) longest = note;
  }
  return longest;
}

namespace {

// Names the Debian package with fonts for a character.
std::string package_for(const std::string& character) {
  const char32_t point = code_points(character).front();
  if (is_ideographic(point) || (point >= 0x1100 && point <= 0x11FF) || (point >= 0xAC00 && point <= 0xD7FF))
    return "fonts-noto-cjk";
  return point >= 0x1F000 && point <= 0x1FBFF ? "fonts-symbola" : "fonts-noto-core";
}

std::string remedy_for(const std::vector<std::string>& missing) {
  if (!searches_fonts())
    return "this build draws with one font alone, because fontconfig and raqm were missing (Debian: libfontconfig-dev, "
           "libraqm-dev)";
  std::vector<std::string> packages;
  for (const std::string& character : missing) {
    std::string package = package_for(character);
    if (std::ranges::find(packages, package) == packages.end()) packages.push_back(std::move(package));
  }
  return fmt::format("a font that has {} may be in Debian's {}", missing.size() == 1 ? "it" : "them",
                     fmt::join(packages, " and "));
}

}  // namespace

std::optional<Problem> letters_warning(const Script& script, const Font& font) {
  if (font.empty()) return std::nullopt;
  std::vector<std::string> missing, where;
  std::optional<FilePlace> place;
  for (const ShownWords& shown : words_of(script)) {
    const std::vector<std::string> here = characters_without_glyph(font, shown.words);
    if (here.empty()) continue;
    if (!place) place = shown.place;
    if (std::ranges::find(where, shown.what) == where.end()) where.push_back(shown.what);
    for (const std::string& one : here)
      if (std::ranges::find(missing, one) == missing.end()) missing.push_back(one);
  }
  if (!place) return std::nullopt;
  return Problem{*place,
                 fmt::format("no font has '{}', which {} {}: boxes are drawn instead; {}", fmt::join(missing, "', '"),
                             fmt::join(where, " and "), where.size() == 1 ? "has" : "have", remedy_for(missing))};
}

}  // namespace supple
