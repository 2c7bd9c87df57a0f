#include "film/plan/shipped_files.h"

#include <algorithm>
#include <iterator>
#include <system_error>

#include "base/companion_program.h"
#include "base/error.h"
#include "base/near_files.h"
#include "base/read_file.h"
#include "base/text.h"
#include "render/font_search.h"
#include "scene/reading/model_scene.h"

namespace supple {
namespace {

std::filesystem::path shared_folder() {
  std::error_code error;
  const std::filesystem::path folder = this_program().parent_path();
  // The first way leads to the files from supple itself, the second from a program that supple starts, the third from
  // Python's module. A Python package that pip made has them in its own folder.
  for (const char* way : {SUPPLE_SHARE_FROM_BIN, SUPPLE_SHARE_FROM_LIBEXEC, SUPPLE_SHARE_FROM_MODULE, "."}) {
    const std::filesystem::path installed = (folder / way).lexically_normal();
    if (std::filesystem::is_directory(installed / "shaders", error)) return installed;
  }
  return SUPPLE_SOURCE_FOLDER;
}

}  // namespace

std::filesystem::path assets_folder() { return shared_folder() / "assets"; }
std::filesystem::path shaders_folder() { return shared_folder() / "shaders"; }

std::vector<std::string> shipped_names(const std::string& kind) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(assets_folder() / kind, error)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

// Names the installed families whose names begin with the word, or the one that is nearest to it.
std::string similar_families(const std::string& word) {
  const std::vector<std::string> all = font_families();
  std::vector<std::string> begin_so;
  std::ranges::copy_if(all, std::back_inserter(begin_so), [start = lowercase(word)](const std::string& family) {
    return lowercase(family).starts_with(start);
  });
  return begin_so.empty() ? did_you_mean(word, all) : "; there is " + name_list(std::move(begin_so));
}

Font font_asked_for(const TextDef& text) {
  if (!searches_fonts())
    throw InputError({Problem{text.font_place,
                              "font: this build cannot look for fonts: fontconfig and raqm were missing "
                              "(Debian: libfontconfig-dev, libraqm-dev)"}});
  if (std::optional<Font> font = font_of_family(text.font)) return *font;
  throw InputError({Problem{text.font_place, fmt::format("font: no font of the family '{}' is installed{}", text.font,
                                                         similar_families(text.font))}});
}

}  // namespace

Font text_font(const TextDef& text) {
  if (!text.font.empty()) return font_asked_for(text);
  for (const char* font :
       {"/usr/share/fonts/truetype/lato/Lato-Regular.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
        "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"}) {
    std::error_code error;
    if (std::filesystem::exists(font, error)) return {font, 0};
  }
  return font_with(U'a').value_or(Font{});
}

std::filesystem::path scene_file(const std::string& name) {
  std::error_code error;
  // A folder is not taken for the scene, because folders are often named after the scene that was filmed into them.
  if (std::filesystem::exists(name, error) && !std::filesystem::is_directory(name, error)) return name;
  for (const char* kind : {"scenes", "replays"}) {
    const std::filesystem::path shipped = assets_folder() / kind / (name + ".toml");
    if (std::filesystem::exists(shipped, error)) return shipped;
  }
  if (std::filesystem::exists(name, error)) return name;
  std::vector<std::string> shipped = shipped_names("scenes");
  for (std::string& replay : shipped_names("replays")) shipped.push_back(std::move(replay));
  const auto is_input = [](const std::filesystem::path& file) { return file.extension() == ".toml" || is_model(file); };
  throw InputError(name, "no such file" + meant_file(near_file(name, is_input, shipped)));
}

SceneSource scene_source(const std::string& name) {
  constexpr std::uintmax_t largest = 1'000'000;  // the same bound as for a scene's file
  if (name == "-") return {SceneSource::standard_input, read_standard_input(largest)};
  return scene_file(name);
}

}  // namespace supple
