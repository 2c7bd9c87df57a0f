#include "film/plan/run_choice.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "output/files/json_text.h"

namespace supple {
namespace {

using SortedJson = nlohmann::json;  // its keys are sorted, so that equal values have equal texts

// Says what a folder holds that a run would take over.
enum class Holds { nothing, same_film, another };

bool has_files(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_directory(folder, error) && !std::filesystem::is_empty(folder, error);
}

// Tells whether a run would remove results of a kind that it does not make itself.
bool leaves_less(const FilmPlan& plan, const std::filesystem::path& run) {
  std::error_code error;
  const bool pictures = plan.pictures == FilmPictures::all && !plan.film_only;
  if (!pictures && has_files(run / "frames")) return true;
  for (const Name<FilmFormat>& format : Names<FilmFormat>::table) {
    const std::string film = film_file(format.value);
    if (!plan.wants_video() && !film.empty() && std::filesystem::exists(run / film, error)) return true;
  }
  return (plan.save_states.empty() && has_files(run / "states")) ||
         (plan.fields_every == 0 && has_files(run / "fields"));
}

// Returns all that tells one film from another.
SortedJson film_of(const SortedJson& info) {
  SortedJson film;
  for (const char* key : {"program", "scene", "replay", "meshes", "sweep_point"}) {
    if (info.contains(key)) film[key] = info[key];
  }
  return film;
}

Holds what_is_in(const std::filesystem::path& run, const FilmPlan& plan, const SortedJson& info) {
  std::error_code error;
  if (!std::filesystem::exists(run / "run.json", error)) return Holds::nothing;
  const auto before = json_object_in<SortedJson>(run / "run.json");
  if (before.is_object() && !before.contains("ended")) return Holds::nothing;  // a run that had only begun
  if (!before.is_object()) return Holds::another;
  // An earlier preview is there to be replaced.
  if (plan.preview && before.contains("preview") && before["preview"] == true) return Holds::nothing;
  const bool without_frames = before["ended"] != "running" && before.contains("frames") && before["frames"] == 0;
  if (without_frames) return Holds::nothing;
  return film_of(before) == film_of(info) && !leaves_less(plan, run) ? Holds::same_film : Holds::another;
}

// Returns the folder's path in a form to which a number can be added: without a slash at its end, and with a name.
std::filesystem::path named(const std::filesystem::path& path) {
  std::filesystem::path result = path.lexically_normal();
  if (!result.has_filename()) result = result.parent_path();
  if (result.empty() || result.filename() == "." || result.filename() == "..")
    result = (std::filesystem::absolute(path) / "").lexically_normal().parent_path();
  return result;
}

}  // namespace

RunPlace place_of_run(const std::filesystem::path& asked, const FilmPlan& plan, const RunInfo& info) {
  if (plan.force || plan.resume || plan.folder_is_locked) return {asked, "", true};
  const SortedJson now = json_if_valid<SortedJson>(info_json(info));
  std::filesystem::path path = asked;
  std::error_code error;
  for (int number = 2;; ++number) {
    const Holds held = what_is_in(path, plan, now);
    const bool is_first = number == 2;
    // A numbered folder is taken only where it is free or holds a run.
    const bool free = is_first || !std::filesystem::exists(path, error) ||
                      (std::filesystem::is_directory(path, error) &&
                       (!has_files(path) || std::filesystem::exists(path / "run.json", error)));
    if (free && held != Holds::another) {
      std::string note;
      if (!is_first) {
        note = fmt::format("{} holds another run, which stays; this one goes to {} (--force overwrites)",
                           asked.string(), path.string());
      } else if (held == Holds::same_film) {
        note = path.string() + " holds this same film, which is made again";
      }
      return {path, note, is_first};
    }
    path = named(asked);
    path += fmt::format("-{}", number);
  }
}

}  // namespace supple
