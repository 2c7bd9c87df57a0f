// Checks for reasons to refuse a film before anything in its folder is changed. All functions here throw InputError.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "film/record/checkpoint.h"
#include "film/record/state_record.h"
#include "output/run/run_folder.h"
#include "scene/building/assemble.h"

namespace supple {

struct SceneDef;

// Returns the checkpoint from which a film is resumed, if there is one yet, and prints a note about it. Refuses a
// complete film without a checkpoint, and a film of another scene or program.
std::optional<WorldState> checkpoint_in(const std::filesystem::path& run, const std::string& identity, int frames,
                                        const RunInfo& info);

// Checks the rows and the motion of the first frames, which are not made again. check_pictures() checks their pictures.
void check_rows_and_motion(const std::filesystem::path& run, const std::vector<Body>& bodies, const SceneDef& scene,
                           int frames);

// Checks the pictures of frames that are not made again.
void check_pictures(const std::filesystem::path& frames, int count);

// Does the same for their passes.
void check_kept_passes(const std::filesystem::path& passes, const SceneDef& scene, int count);

// Prints a note where the pictures that are not made again have graphs of another length, because the film was begun
// with another number of frames.
void note_other_graphs(const SceneDef& scene, const std::filesystem::path& run, int kept_frames);

// Checks the file for --record. It must be writable, and nothing of value may be overwritten: it must not be one of the
// run's own files, an existing file must be a record, and that record must begin with the frames that are kept.
void check_record(const std::filesystem::path& record, const std::filesystem::path& run, const RecordHead& head,
                  int kept_frames);

}  // namespace supple
