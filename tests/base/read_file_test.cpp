// Reading whole files: only regular ones, up to a size, and with the system's reason where they cannot be read.
#include "base/read_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "support/bodies.h"

namespace supple {
namespace read_file_test {

std::string refusal_of(const std::filesystem::path& path, std::uintmax_t most_bytes = usual_most_bytes) {
  try {
    (void)read_file(path, most_bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ReadFile, GivesEveryByte) {
  const test::TemporaryFolder folder;
  const std::string bytes("a\0b\r\n\xff", 6);
  std::ofstream(folder.path / "bytes", std::ios::binary) << bytes;
  EXPECT_EQ(read_file(folder.path / "bytes"), bytes);
  std::ofstream(folder.path / "empty");
  EXPECT_EQ(read_file(folder.path / "empty"), "");
  EXPECT_FALSE(read_file("/proc/self/status").empty());  // has no size
}

TEST(ReadFile, TextHasNoByteOrderMark) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "text", std::ios::binary) << "\xef\xbb\xbf"
                                                        << "v 1\n\xef\xbb\xbf";
  EXPECT_EQ(read_text(folder.path / "text"), "v 1\n\xef\xbb\xbf");
  for (const char* mark : {"\xff\xfe", "\xfe\xff"}) {
    std::ofstream(folder.path / "wide", std::ios::binary) << mark << "v";
    EXPECT_THROW((void)read_text(folder.path / "wide"), InputError);
  }
}

TEST(ReadFile, RefusesWhatHasNoEndOrCannotBeRead) {
  const test::TemporaryFolder folder;
  const std::string name = folder.path.string();
  EXPECT_EQ(refusal_of(folder.path / "none"), name + "/none: no such file");
  EXPECT_EQ(refusal_of(folder.path), name + ": is not a file");
  EXPECT_EQ(refusal_of("/dev/zero"), "/dev/zero: is not a file");
  EXPECT_EQ(refusal_of("/proc/self/mem"), "/proc/self/mem: cannot be read: Input/output error");
  std::ofstream(folder.path / "long") << "12345";
  EXPECT_EQ(refusal_of(folder.path / "long", 4), name + "/long: is larger than 4 bytes");
}

}  // namespace read_file_test
}  // namespace supple
