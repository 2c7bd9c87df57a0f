// The program's verbs, a file each. Each adds itself to the command line and returns the exit status when it was
// called.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace supple {

// What main runs once the command line is understood.
using Action = std::function<int()>;

void add_render(CLI::App& app, Action& action, const std::vector<std::string>& command);
void add_replay(CLI::App& app, Action& action, const std::vector<std::string>& command);
void add_sweep(CLI::App& app, Action& action, const std::vector<std::string>& command);
void add_profile(CLI::App& app, Action& action, const std::vector<std::string>& command);
void add_check(CLI::App& app, Action& action);
void add_mesh(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);
void add_list(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_doctor(CLI::App& app, Action& action);
void add_complete(CLI::App& app, Action& action, const std::vector<std::string>& command);

// Where scenes, shapes and shaders are: beside the installed program, or in the source tree it was built from.
std::filesystem::path assets_folder();
std::filesystem::path shaders_folder();

// Names of what ships in a folder of assets ("scenes", "shapes"), sorted; empty when there is no such folder.
std::vector<std::string> shipped_names(const std::string& kind);

// A sans font for captions; empty when none of the known ones is installed.
std::string caption_font();

// A file, or the name of a scene or replay that ships ("squirrel").
std::filesystem::path scene_file(const std::string& name);

}  // namespace supple
