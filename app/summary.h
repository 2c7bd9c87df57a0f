// Makes the text of `supple info`: about a mesh, about a scene before it is run, and about the folder of a run.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/meshes/mesh.h"
#include "output/run/run_record.h"
#include "scene/reading/scene_source.h"

namespace supple {

// Describes a mesh: its counts, extent and quality.
std::string mesh_summary(const TetMesh& mesh);

// Describes a surface: what was done to make a solid of it, its pieces, how thin they are and how many vertices that
// wants. Throws InputError.
std::string surface_summary(const std::filesystem::path& file);

// Describes a scene or replay and its bodies, and measures what a frame's steps cost on this machine: it simulates the
// first frames with this many threads and writes nothing. Throws InputError as loading a scene does.
std::string scene_summary(const SceneSource& source, int threads);

// Lists the values of a scene or replay that may change while it runs, each with its path, type, unit, value, allowed
// values and the cost of a change. The time of a new factor is measured. Throws InputError as loading a scene does.
std::string live_summary(const SceneSource& source);

// Describes what was run, how it ended, its times, and which files there are.
std::string run_summary(const RunRecord& run);

}  // namespace supple
