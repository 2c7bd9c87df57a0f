#include "output/run/frame_rows.h"

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace supple {
namespace {

// Reads lines of a file from its start, wherever others read or write it.
class Lines {
 public:
  Lines(int file, const std::filesystem::path& name) : file_(file), name_(name) {}

  std::string next() {
    std::string line;
    for (;;) {
      const char* begin = buffer_.data() + at_;
      const auto* end = static_cast<const char*>(std::memchr(begin, '\n', filled_ - at_));
      if (end != nullptr) {
        line.append(begin, end);
        at_ += std::size_t(end - begin) + 1;
        return line;
      }
      line.append(begin, filled_ - at_);
      fill();
    }
  }

 private:
  void fill() {
    ssize_t read = 0;
    do {
      read = pread(file_, buffer_.data(), buffer_.size(), offset_);
    } while (read < 0 && errno == EINTR);
    if (read < 0) throw RunError(fmt::format("{}: cannot be read: {}", name_.string(), std::strerror(errno)));
    if (read == 0) throw RunError(fmt::format("{}: has fewer rows than were written", name_.string()));
    offset_ += read;
    filled_ = std::size_t(read);
    at_ = 0;
  }

  int file_;
  const std::filesystem::path& name_;
  std::array<char, 1 << 16> buffer_;
  std::size_t filled_ = 0, at_ = 0;
  off_t offset_ = 0;
};

}  // namespace

void FrameRows::each(const std::function<void(const FrameRow&)>& take) const {
  if (rows_ != nullptr) {
    for (const FrameRow& row : *rows_) take(row);
    return;
  }
  if (size_ == 0) return;
  Lines lines(fileno(file_.get()), name_);
  try {
    for (int row = 0; row < size_; ++row) take(row_of_line(lines.next(), name_.string()));
  } catch (const InputError& error) {
    throw RunError(error.what());
  }
}

}  // namespace supple
