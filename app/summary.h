// What `supple info` says, as text for people: of a mesh, of a scene before it is run, of the folder of a run after it.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/mesh.h"
#include "output/run_record.h"

namespace supple {

// Counts, extent and quality.
std::string mesh_summary(const TetMesh& mesh);

// What the film of a scene or replay and its bodies are, and what a frame's steps cost on this machine: the first
// frames are simulated, on this many threads, and nothing is written. Throws InputError as loading a scene does.
std::string scene_summary(const std::filesystem::path& file, int threads);

// The values of a scene or replay that may change while it runs: path, type, unit, value, what is allowed, what a
// change costs. A new factor is timed. Throws InputError as loading a scene does.
std::string live_summary(const std::filesystem::path& file);

// What was run, how it ended, times, and the files that are there.
std::string run_summary(const RunRecord& run);

}  // namespace supple
