// What a film is refused for before anything in its folder is touched: all here throw InputError.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/checkpoint.h"
#include "app/state_record.h"
#include "output/run_folder.h"
#include "scene/scene_def.h"

namespace supple {

// Of --save-state, in a film that begins or goes on with frame `start`.
void check_save_states(const std::vector<int>& frames, const SceneDef& scene, const std::filesystem::path& run,
                       int start);

// What a film goes on from, if there is anything yet; says which. A film that ended complete, and one of another scene
// or program, is not taken for a beginning.
std::optional<Checkpoint> checkpoint_in(const std::filesystem::path& run, const std::string& identity, int frames,
                                        const RunInfo& info);

// What the first frames have left, which are not made again, but for their pictures.
void check_rows_and_motion(const std::filesystem::path& run, const std::vector<Body>& bodies, int colliders,
                           int frames);

// The pictures of frames that are not made again.
void check_pictures(const std::filesystem::path& frames, int count);

// The file for --record, which must be one that can be written and that nobody misses: none of the run's own, no other
// file than a record, and one that begins with the frames that are kept.
void check_record(const std::filesystem::path& record, const std::filesystem::path& run, const RecordHead& head,
                  int kept_frames);

}  // namespace supple
