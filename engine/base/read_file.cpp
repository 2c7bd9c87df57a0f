#include "base/read_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/text.h"

namespace supple {
namespace {

class Descriptor {
 public:
  // A pipe without a writer must not block, so the file is opened without waiting.
  explicit Descriptor(const std::filesystem::path& path)
      : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (file_ >= 0) ::close(file_);
  }
  int number() const { return file_; }

 private:
  int file_;
};

[[noreturn]] void refuse(const std::filesystem::path& path, int reason) {
  throw InputError(path.string(),
                   reason == ENOENT ? "no such file" : fmt::format("cannot be read: {}", std::strerror(reason)));
}

}  // namespace

void check_regular_file(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) refuse(path, errno);
  if (!S_ISREG(status.st_mode)) throw InputError(path.string(), "is not a file");
}

std::string read_file(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  check_regular_file(path);
  const Descriptor file(path);
  if (file.number() < 0) refuse(path, errno);
  struct stat status {};
  if (::fstat(file.number(), &status) != 0) refuse(path, errno);
  const auto refuse_size = [&] {
    throw InputError(path.string(), fmt::format("is larger than {}", bytes_text(most_bytes)));
  };
  if (std::uintmax_t(status.st_size) > most_bytes) refuse_size();
  std::string text;
  // One byte more than the size, so that the end is found without growing.
  text.resize(std::size_t(status.st_size) + 1);
  std::size_t done = 0;
  for (;;) {
    const ssize_t count = ::read(file.number(), text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(path, errno);
    if (count == 0) break;
    done += std::size_t(count);
    if (done > most_bytes) refuse_size();
    if (done == text.size()) text.resize(2 * text.size());
  }
  text.resize(done);
  return text;
}

std::string read_text(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  std::string text = read_file(path, most_bytes);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw InputError(path.string(), "is a text of 16-bit characters (UTF-16); it must be saved as UTF-8 or ASCII");
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  return text;
}

std::string read_standard_input(std::uintmax_t most_bytes) {
  std::string text;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t count = ::read(STDIN_FILENO, part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse("<stdin>", errno);
    if (count == 0) return text;
    text.append(part.data(), std::size_t(count));
    if (text.size() > most_bytes) throw InputError("<stdin>", fmt::format("is larger than {}", bytes_text(most_bytes)));
  }
}

}  // namespace supple
