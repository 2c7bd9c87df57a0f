#include "film/picture_words.h"

#include <fmt/core.h>

namespace supple {
namespace {

void add(std::string& line, const std::string& word) { line += (line.empty() ? "" : ", ") + word; }

}  // namespace

std::string headline_text(const SceneDef& scene, double time) {
  std::string line;
  if (scene.text.title) line = scene.title;
  if (scene.text.time) line += fmt::format("{}t = {:.2f} s", line.empty() ? "" : "    ", time);
  return line;
}

std::string longest_headline(const SceneDef& scene) {
  // Digits are about equally wide, and the last time has the most of them.
  return headline_text(scene, scene.frames / scene.fps);
}

std::string note_text(const TextDef& text, const BodyDef& body, const BodyRow* row) {
  std::string line;
  if (text.method) add(line, std::string(name_of(body.solver.method)));
  if (row == nullptr) return line;
  if (text.iterations) add(line, fmt::format("{} iterations", row->iterations));
  if (text.milliseconds) add(line, fmt::format("{:.1f} ms", row->step_ms));
  if (text.error && row->error_measured) add(line, fmt::format("error {:.1e}", row->error.value_or(0)));
  if (text.error && !row->error_measured) add(line, fmt::format("error about {:.1e}", row->error_estimate));
  return line;
}

std::string longest_note(const SceneDef& scene) {
  BodyRow wide;
  wide.iterations = 1000;
  wide.step_ms = 1000;
  wide.error_estimate = 8.8e-88;
  std::string longest;
  for (const BodyDef& body : scene.bodies) {
    const std::string note = note_text(scene.text, body, &wide);
    if (note.size() > longest.size()) longest = note;
  }
  return longest;
}

}  // namespace supple
