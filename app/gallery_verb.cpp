#include <fmt/core.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/interrupts.h"
#include "base/names.h"
#include "base/text.h"
#include "base/timing.h"
#include "film/plan/shipped_files.h"
#include "output/files/child_program.h"
#include "output/files/folder_lock.h"
#include "output/files/json_text.h"
#include "output/files/whole_file.h"
#include "output/pages/gallery_page.h"
#include "render/gl_context.h"
#include "scene/replay/script.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

// Describes a gallery as the command line asks for it.
struct GalleryCommand {
  std::string scenes;  // a folder; empty: those that ship
  std::string out = "out/gallery";
  int width = 640, frames = 0;
  std::vector<std::string> settings;
  std::string gl = "auto";
  bool preview = false, again = false, quiet = false;

  std::filesystem::path folder(const std::string& scene) const { return std::filesystem::path(out) / "runs" / scene; }
  std::filesystem::path record(const std::string& scene) const {
    return std::filesystem::path(out) / "runs" / (scene + ".json");
  }
};

struct ListedScene {
  std::string name, title;
  std::filesystem::path file;
  std::vector<std::string> words;  // that film it; empty where the scene cannot be read
  std::string identity;            // of all that its film depends on and that is cheap to know
};

std::vector<std::filesystem::path> files_of(const GalleryCommand& command) {
  const std::filesystem::path folder =
      command.scenes.empty() ? assets_folder() / "scenes" : std::filesystem::path(command.scenes);
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) throw InputError(folder.string(), "is not a folder of scenes");
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".toml" && entry.is_regular_file(error)) files.push_back(entry.path());
  }
  if (files.empty()) throw InputError(folder.string(), "holds no scene (.toml)");
  std::sort(files.begin(), files.end());
  return files;
}

// Returns the words with which the program films a scene within the gallery's bounds.
std::vector<std::string> words_for(const GalleryCommand& command, const ListedScene& listed, const SceneDef& scene) {
  std::vector<std::string> words = {std::filesystem::read_symlink("/proc/self/exe").string(),
                                    "render",
                                    "--out=" + command.folder(listed.name).string(),
                                    "--force",
                                    "--quiet",
                                    "--gl",
                                    command.gl};
  if (command.preview) {
    words.emplace_back("--preview");
  } else if (scene.output.width > command.width) {
    const double share = double(command.width) / scene.output.width;
    const auto height = std::max(16, 2 * static_cast<int>(std::lround(scene.output.height * share / 2)));
    words.insert(words.end(), {"--set", fmt::format("output.width={}", command.width / 2 * 2), "--set",
                               fmt::format("output.height={}", height)});
  }
  if (command.frames > 0 && command.frames < scene.frames)
    words.insert(words.end(), {"--frames", std::to_string(command.frames)});
  for (const std::string& setting : command.settings) words.insert(words.end(), {"--set", setting});
  words.insert(words.end(), {"--", listed.file.string()});
  return words;
}

void write_record(const GalleryCommand& command, const ListedScene& scene, int status, const std::string& message) {
  std::filesystem::create_directories(std::filesystem::path(command.out) / "runs");
  const Json record = {{"identity", scene.identity}, {"exit_status", status}, {"message", message}};
  write_whole_file(command.record(scene.name), json_text(record, 1) + "\n");
}

Json record_of(const GalleryCommand& command, const ListedScene& scene) {
  std::ifstream file(command.record(scene.name));
  const Json record = file ? json_if_valid<Json>(file) : Json();
  return record.is_object() && record.value("identity", "") == scene.identity ? record : Json();
}

// Reads a scene so far that its bounds are known. A scene that is wrong is recorded as one that failed.
ListedScene listed(const GalleryCommand& command, const std::filesystem::path& file) {
  ListedScene result{file.stem().string(), "", file, {}, ""};
  try {
    const Script script = Script::load(file, assets_folder(), command.settings);
    result.title = script.scene().title;
    result.words = words_for(command, result, script.scene());
    std::string all = hash_text_form(program_identity()) + script.scene_json() + script.replay_json();
    for (std::size_t i = 2; i < result.words.size(); ++i) all += '\n' + result.words[i];
    result.identity = hash_text_form(hash_text(all));
  } catch (const InputError& error) {
    result.identity = hash_text_form(hash_text(error.what()));
    write_record(command, result, 2, error.what());
  }
  return result;
}

bool is_done(const GalleryCommand& command, const ListedScene& scene) {
  const Json record = record_of(command, scene);
  return record.is_object() && !command.again && record.value("exit_status", 1) == 0;
}

// Films a scene in a process of its own. Returns false when the gallery was interrupted meanwhile.
bool film(const GalleryCommand& command, const ListedScene& scene, const std::string& place) {
  const Stopwatch watch;
  std::error_code error;
  std::filesystem::remove(command.record(scene.name), error);
  const auto end = run_program(scene.words, interrupted);
  if (!end) throw RunError("the program cannot be started once more for a scene");
  if (interrupted()) return false;
  const int status = WIFEXITED(end->status) ? WEXITSTATUS(end->status) : 128 + WTERMSIG(end->status);
  std::string message = status == 0 ? "" : end->output.empty() ? how_it_ended(*end) : end->output;
  message.erase(message.find_last_not_of('\n') + 1);
  write_record(command, scene, status, message);
  if (!command.quiet)
    say(stderr, fmt::format("{} {}: {} in {}\n", place, scene.name, status == 0 ? "done" : "failed",
                            duration_text(watch.elapsed_ms() / 1000)));
  return true;
}

void check_out(const GalleryCommand& command) {
  const std::string option = "--out " + command.out;
  std::error_code error;
  if (!std::filesystem::exists(command.out, error)) return;
  if (!std::filesystem::is_directory(command.out, error)) throw InputError(option, "exists and is not a folder");
  const bool known = std::filesystem::exists(std::filesystem::path(command.out) / "gallery.json", error);
  if (!known && !std::filesystem::is_empty(command.out, error))
    throw InputError(option, "holds files that no gallery left there (no gallery.json); choose another folder");
}

// Makes the page of what there is. Returns the number of scenes without a whole film.
std::size_t write_page(const GalleryCommand& command, const std::vector<ListedScene>& scenes) {
  std::vector<GalleryScene> shown;
  std::size_t troubled = 0;
  std::error_code error;
  for (const ListedScene& scene : scenes) {
    const Json record = record_of(command, scene);
    std::string trouble = record.is_object() ? record.value("message", "") : "not filmed yet";
    if (record.is_object() && record.value("exit_status", 1) != 0 && trouble.empty()) trouble = "failed";
    troubled += trouble.empty() ? 0 : 1;
    const std::filesystem::path run = command.folder(scene.name);
    const bool has_run = record.is_object() && !scene.words.empty() && std::filesystem::exists(run, error);
    shown.push_back({scene.name, scene.title, has_run ? run : std::filesystem::path(), trouble});
  }
  const std::string heading =
      command.scenes.empty() ? "The scenes that ship with supple" : "The scenes in " + command.scenes;
  const std::string note = fmt::format("{} of {} filmed{}. Films play under the pointer, and when they are clicked.",
                                       scenes.size() - troubled, scenes.size(), command.preview ? " as previews" : "");
  const std::filesystem::path page = std::filesystem::path(command.out) / "index.html";
  write_whole_file(page, gallery_page(heading, note, shown));
  if (!command.quiet) say(stdout, fmt::format("  page     {}\n", page.string()));
  return troubled;
}

int make_gallery(const GalleryCommand& command) {
  const std::vector<std::filesystem::path> files = files_of(command);
  check_out(command);
  const FolderLock lock(command.out);
  write_whole_file(std::filesystem::path(command.out) / "gallery.json", std::string_view("{}\n"));
  std::vector<ListedScene> scenes, left;
  for (const std::filesystem::path& file : files) scenes.push_back(listed(command, file));
  std::copy_if(scenes.begin(), scenes.end(), std::back_inserter(left),
               [&](const ListedScene& scene) { return !scene.words.empty() && !is_done(command, scene); });
  const auto done = std::ranges::count_if(scenes, [&](const ListedScene& scene) { return is_done(command, scene); });
  if (!command.quiet && done > 0) say(stderr, fmt::format("{} of {} scenes are done\n", done, scenes.size()));
  catch_interrupts();
  bool whole = true;
  for (std::size_t i = 0; i < left.size() && whole; ++i)
    whole = !interrupted() && film(command, left[i], fmt::format("{} of {},", i + 1, left.size()));
  const std::size_t troubled = write_page(command, scenes);
  if (!whole) {
    say(stderr, "supple: interrupted; the same command goes on with the scene that was cut short\n");
    return 130;
  }
  if (troubled == 0) return 0;
  say(stderr, fmt::format("supple: {} of {} scenes failed:\n", troubled, scenes.size()));
  for (const ListedScene& scene : scenes) {
    const Json record = record_of(command, scene);
    if (record.value("exit_status", 1) != 0)
      say(stderr, fmt::format("  {}: {}\n", scene.name, record.value("message", "")));
  }
  return 1;
}

}  // namespace

void add_gallery(CommandLine& line) {
  auto command = std::make_shared<GalleryCommand>();
  Verb verb = line.verb("gallery", "Film all scenes that ship, or a folder of scenes, onto one HTML page.");
  verb.footer(
      "Examples: supple gallery --preview\n"
      "          supple gallery my-scenes --frames 60 --out out/mine\n"
      "Leaves runs/ and index.html, which needs no other file. The same command goes on where it stopped, and films "
      "again what has changed.");
  verb.option("FOLDER", command->scenes, "folder of scene files [the scenes that ship]");
  verb.option("--out", command->out, "folder for the results").shows_default();
  verb.option("--width", command->width, "most pixels of the pictures' width").between(16, 8192).shows_default();
  verb.option("--frames", command->frames, "most frames of a film [the scene's]").between(1, 1000000);
  verb.flag("--preview", command->preview, "previews of all: small pictures, coarse meshes").excludes({"--width"});
  verb.option("--set", command->settings, "path=value over those of all scenes; may be repeated").repeatable();
  verb.option("--gl", command->gl, word_list(all_names<GlChoice>())).one_of(all_names<GlChoice>());
  verb.flag("--again", command->again, "film scenes that are done once more");
  verb.flag("--quiet", command->quiet, "say nothing but errors");
  verb.runs([command] { return make_gallery(*command); });
}

}  // namespace supple
