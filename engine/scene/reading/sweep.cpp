#include "scene/reading/sweep.h"

#include <algorithm>
#include <set>
#include <utility>

#include "scene/reading/model_scene.h"
#include "scene/reading/replay_start.h"
#include "scene/reading/scene_reader.h"

namespace supple {
namespace {

void check_paths(const SweepDef& sweep, Config& config) {
  std::set<std::string> seen;
  const auto complain = [&](const PathList& axis, const std::string& message) {
    config.complain({axis.place, message});
  };
  for (const PathList& axis : sweep.axes) {
    if (!seen.insert(axis.path).second) complain(axis, fmt::format("'{}' is listed twice", axis.path));
    if (axis.path == "sweep" || axis.path.starts_with("sweep.")) complain(axis, "a sweep cannot vary itself");
    if (sweep.mode == SweepMode::list && axis.values.size() != sweep.axes.front().values.size())
      complain(axis, fmt::format("{}: {} values; '{}' has {}, and in mode \"list\" all have the same number", axis.path,
                                 axis.values.size(), sweep.axes.front().path, sweep.axes.front().values.size()));
  }
}

// Returns the document of a scene, or of the scene that a replay starts with, after the settings.
Config config_of(const SceneSource& source, const std::filesystem::path& assets,
                 const std::vector<std::string>& settings) {
  Config config = load_document(source, assets);
  if (is_replay(config)) {
    Config replay = config.copy();
    std::vector<Problem> problems;
    config = start_of_replay(replay, assets, problems,
                             [](Config& document, const std::string& key, const ConfigValue& value,
                                const FilePlace& place) { document.put(key, value, place, exclusive_keys()); });
    if (!problems.empty()) throw InputError(problems);
  }
  for (const std::string& setting : settings) config.set(setting, exclusive_keys());
  return config;
}

void set_point(Config& config, const SweepDef& sweep, std::size_t point) {
  const std::vector<std::size_t> choice = sweep.choice(point);
  config.remove("sweep");
  for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
    const ListedValue& chosen = sweep.axes[a].values[choice[a]];
    config.put(sweep.axes[a].path, chosen.value, chosen.place, exclusive_keys());
  }
}

// Returns a text such as "mu=3, solver.iterations=5".
std::string point_text(const SweepDef& sweep, std::size_t point) {
  const std::vector<std::string> values = sweep.values(point);
  std::string text;
  for (std::size_t a = 0; a < values.size(); ++a)
    text += fmt::format("{}{}={}", a > 0 ? ", " : "", sweep.axes[a].path, values[a]);
  return text;
}

// Returns the problems of the scene at one point.
std::vector<Problem> problems_of_point(const Config& base, const SweepDef& sweep, std::size_t point) {
  try {
    Config config = base.copy();
    set_point(config, sweep, point);
    (void)read_scene(config);
    return config.take_problems();
  } catch (const InputError& error) {
    return error.problems();
  }
}

}  // namespace

std::size_t SweepDef::points() const {
  if (axes.empty()) return 0;
  if (mode == SweepMode::list) return axes.front().values.size();
  std::size_t count = 1;
  for (const PathList& axis : axes) {
    count *= axis.values.size();
    if (count > most_sweep_points) return most_sweep_points + 1;  // too many in any case; counting on could overflow
  }
  return count;
}

std::vector<std::size_t> SweepDef::choice(std::size_t point) const {
  std::vector<std::size_t> chosen(axes.size(), point);
  if (mode == SweepMode::list) return chosen;
  for (std::size_t a = axes.size(); a-- > 0;) {
    chosen[a] = point % axes[a].values.size();
    point /= axes[a].values.size();
  }
  return chosen;
}

std::vector<std::string> SweepDef::values(std::size_t point) const {
  const std::vector<std::size_t> chosen = choice(point);
  std::vector<std::string> texts;
  for (std::size_t a = 0; a < axes.size(); ++a) texts.push_back(axes[a].values[chosen[a]].text);
  return texts;
}

SweepDef read_sweep(const ConfigTable& root) {
  SweepDef sweep;
  const auto table =
      root.table({"sweep", "", "the scene with other values, point by point; only `supple sweep` uses it"});
  if (!table) return sweep;
  sweep.mode = table->word<SweepMode>(
      {"mode", "", "grid: every combination, the first path slowest; list: the first values, the second ones, ..."},
      SweepMode::grid);
  const auto values = table->table(
      {"values", "", "lists of values by path, the paths as in --set: \"body.soft.material.mu\" = [1e4, 4e4]"},
      "required");
  if (!values) {
    if (!table->has("values")) table->complain("'values' is missing: lists of values by path");
    return sweep;
  }
  sweep.axes = values->path_lists();
  if (values->keys().empty()) values->complain("a sweep needs at least one path with a list of values");
  check_paths(sweep, root.config());
  if (sweep.points() > most_sweep_points) values->complain(fmt::format("more than {} points", most_sweep_points));
  return sweep;
}

SweepDef load_sweep(const SceneSource& source, const std::filesystem::path& assets,
                    const std::vector<std::string>& settings) {
  Config config = config_of(source, assets, settings);
  (void)read_scene(config);
  config.finish();
  const SweepDef sweep = read_sweep(config.root());
  if (sweep.points() == 0) {
    throw InputError(
        source.path.string(),
        "has no [sweep] table; one can also be given, as in --set 'sweep.values.solver.iterations=[5, 10]'");
  }
  for (const std::string& setting : settings) {
    const std::string set = setting.substr(0, setting.find('='));
    for (const PathList& axis : sweep.axes)
      if (axis.path == set) throw InputError("--set " + setting, "the sweep varies this");
  }
  return sweep;
}

void put_sweep_point(Config& config, std::size_t point) {
  Config reader = config.copy();
  const SweepDef sweep = read_sweep(reader.root());
  SUPPLE_CHECK(point, <, sweep.points());
  set_point(config, sweep, point);
}

std::string sweep_point_json(const std::filesystem::path& path, const std::filesystem::path& assets,
                             const std::vector<std::string>& settings, const SweepDef& sweep, std::size_t point) {
  Config config = config_of(path, assets, settings);
  set_point(config, sweep, point);
  Config document = load_document(path, assets);
  return is_replay(document) ? config.as_json() + document.as_json() : config.as_json();
}

void check_sweep_points(const SceneSource& source, const std::filesystem::path& assets,
                        const std::vector<std::string>& settings, const SweepDef& sweep) {
  const Config base = config_of(source, assets, settings);
  std::vector<Problem> all;
  std::set<std::pair<FilePlace, std::string>> seen;
  for (std::size_t point = 0; point < sweep.points(); ++point) {
    for (Problem& problem : problems_of_point(base, sweep, point)) {
      if (!seen.insert({problem.place, problem.message}).second) continue;
      problem.message =
          fmt::format("{} (first in point {} of the sweep: {})", problem.message, point, point_text(sweep, point));
      all.push_back(std::move(problem));
    }
  }
  if (!all.empty()) throw InputError(std::move(all));
}

}  // namespace supple
