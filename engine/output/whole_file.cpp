#include "output/whole_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/error.h"
#include "output/durable.h"

namespace supple {

namespace {

enum class Durability { usual, synced };

void write(const std::filesystem::path& path, std::span<const std::uint8_t> bytes, Durability durability) {
  const std::string temporary = path.string() + ".part";
  const auto fail = [&](const char* doing) {
    const std::string reason = std::strerror(errno);
    ::unlink(temporary.c_str());
    throw RunError(fmt::format("{}: cannot {}: {}", path.string(), doing, reason));
  };
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail("be created");
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = ::write(file, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int reason = errno;
      ::close(file);
      errno = reason;
      fail("be written");
    }
    done += std::size_t(count);
  }
  const bool synced = durability == Durability::usual || ::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP;
  const int reason = errno;
  if (::close(file) != 0) fail("be written");
  errno = reason;
  if (!synced) fail("be brought to the disk");
  if (std::rename(temporary.c_str(), path.c_str()) != 0) fail("be renamed into place");
  if (durability == Durability::synced)
    sync_to_disk(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

void write_whole_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  write(path, bytes, Durability::usual);
}

void write_whole_file(const std::filesystem::path& path, std::string_view text) {
  write(path, bytes_of(text), Durability::usual);
}

void write_durable_file(const std::filesystem::path& path, std::string_view text) {
  write(path, bytes_of(text), Durability::synced);
}

}  // namespace supple
