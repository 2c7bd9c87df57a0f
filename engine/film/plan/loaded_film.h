// Reads and assembles what a film or a drawing is made of.
#pragma once

#include <string>
#include <vector>

#include "film/plan/film_plan.h"
#include "output/run/run_folder.h"
#include "scene/building/drawn_body.h"
#include "scene/reading/scene_source.h"
#include "world/world.h"

namespace supple {

// Holds a scene or replay that has been read and assembled.
struct LoadedFilm {
  World world;                   // not yet started
  std::vector<DrawnBody> drawn;  // by body, once build_models or make_skins has made them; empty without pictures
  RunInfo info;                  // for run.json; filled in as the film goes along
};

// Returns the scene of a plan as the reader takes it.
SceneSource source_of(const FilmPlan& plan);

// Reads the scene or replay of a film. settings: those of --set. The clock is added to them where the film goes on from
// a frame whose number does not tell the time: from a run that went on itself, or that has another rate. Throws
// InputError.
Script load_script(const SceneSource& source, std::vector<std::string>& settings,
                   std::optional<std::size_t> sweep_point = {});

// Returns the setting for --size. settings: those of --set, which must not say the size as well. Throws InputError.
std::string size_setting(const std::string& size, const std::vector<std::string>& settings);

// Reads the scene and its meshes. command: the command line with which the program was called. Throws InputError.
LoadedFilm load_film(const FilmPlan& plan, const std::vector<std::string>& command);

// Tries every change of the script, and builds the models, and with pictures what is drawn of them. Throws InputError.
void build_models(const FilmPlan& plan, LoadedFilm& film);
// Makes what is drawn of the bodies. build_models calls this, beside its other work.
void make_skins(const FilmPlan& plan, LoadedFilm& film);

// Checks the frames of --save-state for a film that begins, or is resumed, with frame `start`. Throws InputError.
void check_save_states(const std::vector<int>& frames, const SceneDef& scene, const std::filesystem::path& run,
                       int start);

}  // namespace supple
