// Keeps a folder to one process, because two runs that write into one folder destroy each other's results. The lock is
// the system's, on the folder itself: it leaves no file behind, and ends with the process however that ends. Not here:
// machines that share a disk, each of which may know of its own locks only.
#pragma once

#include <filesystem>

namespace supple {

class FolderLock {
 public:
  // Makes the folder if there is none. Holds nothing where that fails, or where the disk knows no locks. Throws
  // InputError when another process has the folder.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_;  // its file descriptor; negative: none
};

}  // namespace supple
