#include "output/files/durable.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "base/error.h"

namespace supple {

void sync_to_disk(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  int reason = file < 0 ? errno : 0;
  if (file >= 0 && ::fsync(file) != 0) reason = errno;
  if (file >= 0) ::close(file);
  // Some file systems, such as those of a network, have nothing to sync.
  if (reason == 0 || reason == EINVAL || reason == EROFS || reason == ENOTSUP) return;
  throw RunError(fmt::format("{}: cannot be brought to the disk: {}", path.string(), std::strerror(reason)));
}

void sync_tree(const std::filesystem::path& folder, std::filesystem::file_time_type since) {
  std::error_code error;
  std::vector<std::filesystem::path> folders = {folder};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, error)) {
    if (entry.is_directory(error)) {
      folders.push_back(entry.path());
    } else if (entry.is_regular_file(error) && entry.path().stem().extension() != ".part" &&
               entry.path().extension() != ".part" && entry.last_write_time(error) >= since && !error) {
      sync_to_disk(entry.path());
    }
  }
  for (const std::filesystem::path& each : folders) sync_to_disk(each);
}

}  // namespace supple
