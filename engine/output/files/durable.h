// Waits until the disk has what was written, so that it is there after the machine has lost its power. Without this,
// a file that was renamed into place may come back empty.
#pragma once

#include <filesystem>

namespace supple {

// Syncs a file's content, or the names in a folder. Does nothing where the file system cannot. Throws RunError naming
// the path and the system's reason.
void sync_to_disk(const std::filesystem::path& path);

// Syncs all files below a folder that were changed at or after a time, and then the folders themselves. Files that are
// still being written under a temporary name (.part) are left out.
void sync_tree(const std::filesystem::path& folder, std::filesystem::file_time_type since);

}  // namespace supple
