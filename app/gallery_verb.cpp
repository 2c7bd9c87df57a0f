#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/jobs.h"
#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/interrupts.h"
#include "base/names.h"
#include "base/text.h"
#include "film/plan/shipped_files.h"
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
  std::vector<std::string> words;          // the command that films it; empty where the scene cannot be read
  std::string identity;                    // hash of all that its film depends on and that is cheap to know
  std::optional<JobOutcome> outcome = {};  // of its film; none where this film was not tried yet
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

// Returns the command line that films a scene within the gallery's bounds.
std::vector<std::string> words_for(const GalleryCommand& command, const ListedScene& listed, const SceneDef& scene) {
  std::vector<std::string> words = {
      "render", "--out=" + command.folder(listed.name).string(), "--force", "--quiet", "--gl", command.gl};
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

// Reads the outcome of this film from the record; nothing where the record tells of another film.
void read_outcome(const GalleryCommand& command, ListedScene& scene) {
  const auto record = json_object_in<Json>(command.record(scene.name));
  const bool of_this_film = record.is_object() && record.value("identity", "") == scene.identity;
  scene.outcome = of_this_film ? std::optional(outcome_in(record)) : std::nullopt;
}

void keep_outcome(const GalleryCommand& command, ListedScene& scene, const JobOutcome& outcome) {
  const Json made_with = {{"identity", scene.identity}};
  write_job_record(command.record(scene.name), made_with, outcome);
  read_outcome(command, scene);
}

// Reads a scene, and returns it with the command that films it and the outcome of its film. A scene that is wrong is
// recorded as one that failed.
ListedScene listed(const GalleryCommand& command, const std::filesystem::path& file) {
  ListedScene result{file.stem().string(), "", file, {}, ""};
  try {
    const Script script = Script::load(file, assets_folder(), command.settings);
    result.title = script.scene().title;
    result.words = words_for(command, result, script.scene());
    std::string all = hash_text_form(program_identity()) + script.scene_json() + script.replay_json();
    for (std::size_t i = 1; i < result.words.size(); ++i) all += '\n' + result.words[i];
    result.identity = hash_text_form(hash_text(all));
    read_outcome(command, result);
  } catch (const InputError& error) {
    result.identity = hash_text_form(hash_text(error.what()));
    keep_outcome(command, result, {2, error.what()});
  }
  return result;
}

bool succeeded(const ListedScene& scene) { return scene.outcome && scene.outcome->exit_status == 0; }

// Returns why a scene has no film.
std::string trouble_of(const ListedScene& scene) {
  if (!scene.outcome) return "not filmed yet";
  return scene.outcome->message.empty() ? "failed" : scene.outcome->message;
}

// Keeps how the film of a scene ended, and says so, unless an interrupt cut it short.
void end_film(const GalleryCommand& command, ListedScene& scene, const JobEnd& end, std::size_t films) {
  scene.outcome.reset();
  if (end.cut_short) return;
  std::string message = end.status == 0 ? "" : end.output.empty() ? end.how : end.output;
  message.erase(message.find_last_not_of('\n') + 1);
  keep_outcome(command, scene, {end.status, message});
  if (!command.quiet)
    say(stderr, fmt::format("{} of {}, {}: {} in {}\n", end.ended, films, scene.name,
                            succeeded(scene) ? "done" : "failed", duration_text(end.seconds)));
}

// Makes the page of what there is. Returns the number of scenes without a whole film.
std::size_t write_page(const GalleryCommand& command, const std::vector<ListedScene>& scenes) {
  std::vector<GalleryScene> shown;
  std::size_t troubled = 0;
  std::error_code error;
  for (const ListedScene& scene : scenes) {
    troubled += succeeded(scene) ? 0 : 1;
    const std::filesystem::path run = command.folder(scene.name);
    const bool has_run = scene.outcome && !scene.words.empty() && std::filesystem::exists(run, error);
    shown.push_back(
        {scene.name, scene.title, has_run ? run : std::filesystem::path(), succeeded(scene) ? "" : trouble_of(scene)});
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

// Films the scenes that need it, one after the other.
void film(const GalleryCommand& command, std::vector<ListedScene>& scenes) {
  std::vector<ListedScene*> left;
  for (ListedScene& scene : scenes) {
    if (!scene.words.empty() && (command.again || !succeeded(scene))) left.push_back(&scene);
  }
  const auto done = command.again ? 0 : std::ranges::count_if(scenes, succeeded);
  if (!command.quiet && done > 0) say(stderr, fmt::format("{} of {} scenes are done\n", done, scenes.size()));
  catch_interrupts();
  run_jobs({"scene", left.size(), 1,
            [&](std::size_t i) {
              return Job{left[i]->words, command.record(left[i]->name)};
            },
            [&](const JobEnd& end) { end_film(command, *left[end.job], end, left.size()); }});
}

int make_gallery(const GalleryCommand& command) {
  const std::vector<std::filesystem::path> files = files_of(command);
  check_left_by(command.out, "gallery", "gallery.json");
  const FolderLock lock(command.out);
  write_whole_file(std::filesystem::path(command.out) / "gallery.json", std::string_view("{}\n"));
  std::vector<ListedScene> scenes;
  for (const std::filesystem::path& file : files) scenes.push_back(listed(command, file));
  film(command, scenes);
  const bool whole = !interrupted();
  const std::size_t troubled = write_page(command, scenes);
  if (!whole) {
    say(stderr, "supple: interrupted; the same command goes on with the scene that was cut short\n");
    return 130;
  }
  if (troubled == 0) return 0;
  say(stderr, fmt::format("supple: {} of {} scenes failed:\n", troubled, scenes.size()));
  for (const ListedScene& scene : scenes) {
    if (!succeeded(scene)) say(stderr, fmt::format("  {}: {}\n", scene.name, trouble_of(scene)));
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
