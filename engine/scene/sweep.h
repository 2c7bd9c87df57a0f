// A sweep: one scene with other values in some places, point by point. The [sweep] table of a scene file says which;
// here they are counted and put into the scene. Nothing here runs anything.
#pragma once

#include "scene/config.h"
#include "scene/scene_def.h"

namespace supple {

constexpr std::size_t most_sweep_points = 100000;

struct SweepDef {
  enum class Mode { grid, list } mode = Mode::grid;  // every combination; or the lists side by side
  std::vector<PathList> axes;                        // in the order of the file; of a grid the last one varies fastest

  std::size_t points() const;  // 0 without axes
  // Of a point: which value of each axis.
  std::vector<std::size_t> choice(std::size_t point) const;
  // Of a point: the values as people read them, an axis each.
  std::vector<std::string> values(std::size_t point) const;
};

// The [sweep] table of a scene; one without axes where there is none. Problems are recorded in the config.
SweepDef read_sweep(const ConfigTable& root);

// Loads a file's sweep after "path=value" settings, which must leave what the sweep varies alone. Throws InputError:
// also when the scene as it stands cannot be read, and when it has no sweep.
SweepDef load_sweep(const std::filesystem::path& path, const std::filesystem::path& assets,
                    const std::vector<std::string>& settings);

// Puts a point's values into a scene's document, and takes its sweep off. Throws InputError where a path is refused.
void put_sweep_point(Config& config, std::size_t point);

// The document of a point's scene, as run.json has it.
std::string sweep_point_json(const std::filesystem::path& path, const std::filesystem::path& assets,
                             const std::vector<std::string>& settings, const SweepDef& sweep, std::size_t point);

// Reads the scene of every point. Throws InputError with all problems, each once.
void check_sweep_points(const std::filesystem::path& path, const std::filesystem::path& assets,
                        const std::vector<std::string>& settings, const SweepDef& sweep);

}  // namespace supple
