// Makes scenes of the texts of cases, in which words stand for what differs from run to run.
#pragma once

#include <string>

#include "film/plan/shipped_files.h"
#include "scene/reading/scene_reader.h"

namespace supple {

// Reads the text of a case's scene. Throws InputError where something is wrong with it.
inline SceneDef scene_of_case(const std::string& text) {
  Config config = Config::parse(text, "hard case", assets_folder());
  SceneDef scene = read_scene(config);
  config.finish();
  return scene;
}

// Puts a value in the place where a word first stands in a text.
inline std::string filled(std::string text, const std::string& word, const std::string& value) {
  if (const std::size_t at = text.find(word); at != std::string::npos) text.replace(at, word.size(), value);
  return text;
}

}  // namespace supple
