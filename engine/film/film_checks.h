// Reasons to refuse a film before anything in its folder is touched. All functions here throw InputError.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "film/checkpoint.h"
#include "film/state_record.h"
#include "output/run_folder.h"
#include "scene/assemble.h"

namespace supple {

// Checks the frames of --save-state, in a film that begins or is resumed with frame `start`.
void check_save_states(const std::vector<int>& frames, const SceneDef& scene, const std::filesystem::path& run,
                       int start);

// The checkpoint that a film is resumed from, if there is one yet; says which. A film that ended complete, and one of
// another scene or program, is not taken for a beginning.
std::optional<Checkpoint> checkpoint_in(const std::filesystem::path& run, const std::string& identity, int frames,
                                        const RunInfo& info);

// Checks what the first frames have left, which are not made again. Their pictures have a function of their own.
void check_rows_and_motion(const std::filesystem::path& run, const std::vector<Body>& bodies, int colliders,
                           int frames);

// Checks the pictures of frames that are not made again.
void check_pictures(const std::filesystem::path& frames, int count);

// Checks the file for --record, which must be one that can be written and that nobody misses: none of the run's own, no
// other file than a record, and one that begins with the frames that are kept.
void check_record(const std::filesystem::path& record, const std::filesystem::path& run, const RecordHead& head,
                  int kept_frames);

}  // namespace supple
