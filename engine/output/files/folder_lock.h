// Keeps folders of results apart from other files, and reserves a folder for one process, or for several that do parts
// of one work, because two runs that write into one folder destroy each other's results. The lock is the system's, on
// the folder itself: it leaves no file behind and ends with the process, in whatever way that ends. It does not protect
// against other machines that share the disk, because each of them may know only of its own locks.
#pragma once

#include <filesystem>
#include <string>

namespace supple {

// Throws InputError when there is something else than a folder, and when the folder holds files but no `mark`
// ("gallery.json"), the file by which a folder is known that a `maker` ("gallery") has left. Where several
// processes may begin at one time, the mark must be what each of them writes first.
void check_left_by(const std::filesystem::path& folder, const std::string& maker, const std::string& mark);

enum class FolderUse { alone, with_others };

class FolderLock {
 public:
  // Makes the folder if there is none. The object holds no lock where that fails, or where the disk supports none.
  // Throws InputError when another process holds the lock; where both use the folder with others, none is in the way.
  explicit FolderLock(const std::filesystem::path& folder, FolderUse use = FolderUse::alone);
  ~FolderLock();
  // From now on, processes that use the folder with others may use it too. Throws InputError when one that uses it
  // alone has come in between.
  void share();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  [[noreturn]] void refuse() const;

  std::filesystem::path path_;
  int folder_;  // its file descriptor; negative without a lock
};

}  // namespace supple
