// Makes the text of `supple info`: about a mesh, about a scene before it is run, and about the folder of a run.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/mesh.h"
#include "output/run_record.h"

namespace supple {

// Tells a mesh's counts, extent and quality.
std::string mesh_summary(const TetMesh& mesh);

// Describes a scene or replay and its bodies, and tells what a frame's steps cost on this machine: the first frames are
// simulated, on this many threads, and nothing is written. Throws InputError as loading a scene does.
std::string scene_summary(const std::filesystem::path& file, int threads);

// Lists the values of a scene or replay that may change while it runs: path, type, unit, value, what is allowed, what a
// change costs. A new factor is timed. Throws InputError as loading a scene does.
std::string live_summary(const std::filesystem::path& file);

// Tells what was run, how it ended, its times, and which files are there.
std::string run_summary(const RunRecord& run);

}  // namespace supple
