#include "output/files/whole_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "base/error.h"
#include "output/files/durable.h"

namespace supple {

namespace {

// Represents a file that is written under a temporary name, which is removed unless the file is finished.
class PartFile {
 public:
  explicit PartFile(const std::filesystem::path& path, const std::string& suffix = ".part")
      : path_(path), temporary_(path.string() + suffix) {
    file_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file_ < 0) fail("be created");
  }
  ~PartFile() {
    if (file_ >= 0) ::close(file_);
    if (!finished_) ::unlink(temporary_.c_str());
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void add(std::span<const std::uint8_t> bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t count = ::write(file_, bytes.data() + done, bytes.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail("be written");
      done += std::size_t(count);
    }
  }

  void sync() {
    if (::fsync(file_) != 0 && errno != EINVAL && errno != ENOTSUP) fail("be brought to the disk");
  }

  // Gives the file its name.
  void finish() {
    if (::close(std::exchange(file_, -1)) != 0) fail("be written");
    if (std::rename(temporary_.c_str(), path_.c_str()) != 0) fail("be renamed into place");
    finished_ = true;
  }

 private:
  [[noreturn]] void fail(const char* doing) const {
    throw RunError(fmt::format("{}: cannot {}: {}", path_.string(), doing, std::strerror(errno)));
  }

  std::filesystem::path path_;
  std::string temporary_;
  int file_ = -1;
  bool finished_ = false;
};

void sync_folder_of(const std::filesystem::path& path) {
  sync_to_disk(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

void write_whole_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  PartFile file(path);
  file.add(bytes);
  file.finish();
}

void write_whole_file_together(const std::filesystem::path& path, std::string_view text) {
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  PartFile file(path, fmt::format(".{}-{}.part", host, ::getpid()));
  file.add(bytes_of(text));
  file.finish();
}

void write_whole_file(const std::filesystem::path& path, std::string_view text) {
  write_whole_file(path, bytes_of(text));
}

void write_durable_file(const std::filesystem::path& path, std::string_view text) {
  write_durable_file(path, [text](const TakesText& take) { take(text); });
}

void write_durable_file(const std::filesystem::path& path, const std::function<void(const TakesText&)>& make) {
  PartFile file(path);
  make([&file](std::string_view piece) { file.add(bytes_of(piece)); });
  file.sync();
  file.finish();
  sync_folder_of(path);
}

}  // namespace supple
