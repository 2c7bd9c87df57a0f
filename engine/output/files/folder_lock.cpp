#include "output/files/folder_lock.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "base/error.h"

namespace supple {

namespace {

// Tells whether a folder holds nothing but the mark, or what another process leaves there while it writes the mark.
bool is_new(const std::filesystem::path& folder, const std::string& mark) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (!entry.path().filename().string().starts_with(mark)) return false;
  }
  return !error;
}

}  // namespace

void check_left_by(const std::filesystem::path& folder, const std::string& maker, const std::string& mark) {
  std::error_code error;
  const std::string option = "--out " + folder.string();
  if (!std::filesystem::exists(folder, error)) return;
  if (!std::filesystem::is_directory(folder, error)) throw InputError(option, "exists and is not a folder");
  if (!is_new(folder, mark) && !std::filesystem::exists(folder / mark, error))
    throw InputError(option,
                     fmt::format("holds files that no {} left there (no {}); choose another folder", maker, mark));
}

FolderLock::FolderLock(const std::filesystem::path& folder, FolderUse use) : path_(folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  // Children do not inherit the descriptor (O_CLOEXEC), because they may live longer.
  folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int kind = use == FolderUse::alone ? LOCK_EX : LOCK_SH;
  if (folder_ < 0 || ::flock(folder_, kind | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(folder_);
  refuse();
}

void FolderLock::refuse() const {
  throw InputError("--out " + path_.string(),
                   "another run writes into this folder now; wait until it has ended, or choose another folder");
}

void FolderLock::share() {
  if (folder_ >= 0 && ::flock(folder_, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK) refuse();
}

FolderLock::~FolderLock() {
  if (folder_ >= 0) ::close(folder_);
}

}  // namespace supple
