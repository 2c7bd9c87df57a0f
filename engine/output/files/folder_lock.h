// Keeps folders of results apart from other files, and reserves a folder for one process, or for several that do parts
// of one work, because two runs that write into one folder destroy each other's results. The lock is the system's, on
// the folder itself: it leaves no file behind and ends with the process, in whatever way that ends. It does not protect
// against other machines that share the disk, because each of them may know only of its own locks.
#pragma once

#include <filesystem>
#include <string>

namespace supple {

// Checks that results of a `maker` ("gallery") may be written into a folder: the folder does not exist, or is empty, or
// holds the file `mark` ("gallery.json"), which shows that such a maker has left the folder. Throws InputError
// otherwise. Where several processes may begin at one time, the mark must be the first file that each of them writes.
void check_left_by(const std::filesystem::path& folder, const std::string& maker, const std::string& mark);

enum class FolderUse { alone, with_others };

class FolderLock {
 public:
  // Makes the folder if there is none. The object holds no lock where that fails, or where the disk supports none.
  // Throws InputError when another process holds the lock, unless both of them use the folder `with_others`.
  explicit FolderLock(const std::filesystem::path& folder, FolderUse use = FolderUse::alone);
  ~FolderLock();
  // Lets other processes that use the folder `with_others` use it from now on. Throws InputError when a process that
  // uses it `alone` has taken the lock in the meantime.
  void share();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  [[noreturn]] void refuse() const;

  std::filesystem::path path_;
  int folder_;  // its file descriptor; negative where it cannot be opened
};

}  // namespace supple
