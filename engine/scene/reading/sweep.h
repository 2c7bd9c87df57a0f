// Defines a sweep: one scene with other values in some places, point by point. The [sweep] table of a scene file lists
// the values; here the points are counted, and their values are put into the scene. Nothing here simulates.
#pragma once

#include "scene/config/config.h"
#include "scene/reading/scene_source.h"

namespace supple {

constexpr std::size_t most_sweep_points = 100000;

enum class SweepMode {
  grid,  // every combination of the lists' values
  list,  // the lists side by side: their first values, their second ones, ...
};
template <>
struct Names<SweepMode> {
  static constexpr std::array table = {Name{SweepMode::grid, "grid"}, Name{SweepMode::list, "list"}};
};

struct SweepDef {
  SweepMode mode = SweepMode::grid;
  std::vector<PathList> axes;  // in the order of the file; of a grid the last one varies fastest

  std::size_t points() const;  // 0 without axes; of a grid, at most most_sweep_points + 1
  // Returns, for each axis, the index of its value at a point.
  std::vector<std::size_t> choice(std::size_t point) const;
  // Returns the value of each axis at a point, as people read it.
  std::vector<std::string> values(std::size_t point) const;
};

// Reads the [sweep] table of a scene. Without that table the result has no axes. Problems are recorded in the config.
SweepDef read_sweep(const ConfigTable& root);

// Loads the sweep of a file after "path=value" settings, which must not set a value that the sweep varies. Throws
// InputError, also when the scene itself cannot be read or has no sweep.
SweepDef load_sweep(const SceneSource& source, const std::filesystem::path& assets,
                    const std::vector<std::string>& settings);

// Puts the values of a point into a scene's document, and removes its sweep. Throws InputError when a path is refused.
void put_sweep_point(Config& config, std::size_t point);

// Returns the document of the scene at a point, in the form that is written to run.json.
std::string sweep_point_json(const std::filesystem::path& path, const std::filesystem::path& assets,
                             const std::vector<std::string>& settings, const SweepDef& sweep, std::size_t point);

// Reads the scene of every point. Throws InputError with all problems, each once.
void check_sweep_points(const SceneSource& source, const std::filesystem::path& assets,
                        const std::vector<std::string>& settings, const SweepDef& sweep);

}  // namespace supple
