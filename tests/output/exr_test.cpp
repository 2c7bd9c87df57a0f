// Tests files of passes by another reader than ours: ffmpeg's own.
#include "output/files/exr_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "base/error.h"
#include "output/files/child_program.h"
#include "output/files/whole_file.h"
#include "support/bodies.h"

namespace supple {
namespace exr_test {

TEST(Exr, FloatsAreReadBackToTheBit) {
  if (!writes_exr()) {
    EXPECT_THROW(exr_bytes(1, 1, std::vector<float>(1)), RunError);
    GTEST_SKIP() << "the program was built without OpenEXR";
  }
  constexpr int width = 37, height = 21;
  const test::TemporaryFolder folder;
  for (const std::size_t channels : {1U, 3U}) {
    std::vector<float> values;
    for (std::size_t i = 0; i < channels * width * height; ++i)
      values.push_back(i % 11 == 0 ? 1e10F : static_cast<float>(0.37 * double(i) - 100 + 1e-5 * double(i % 7)));
    const std::vector<std::uint8_t> bytes = exr_bytes(width, height, values);
    EXPECT_EQ(exr_bytes(width, height, values), bytes);
    const std::filesystem::path file = folder.path / "a.exr", raw = folder.path / "a.raw";
    write_whole_file(file, bytes);
    const auto told = run_program({"ffmpeg", "-v", "error", "-y", "-i", file_word(file), "-f", "rawvideo", "-pix_fmt",
                                   channels == 1 ? "grayf32le" : "gbrpf32le", file_word(raw)});
    if (!told) GTEST_SKIP() << "ffmpeg is not installed";
    ASSERT_EQ(told->status, 0) << told->output;
    const std::string read = test::read_file(raw);
    ASSERT_EQ(read.size(), 4 * values.size());
    constexpr std::size_t plane_of[] = {2, 0, 1};  // ffmpeg's planes are green, blue and red
    for (std::size_t i = 0; i < values.size(); ++i) {
      float value = 0;
      const std::size_t plane = channels == 1 ? 0 : plane_of[i % 3];
      std::memcpy(&value, &read[4 * (plane * width * height + i / channels)], sizeof value);
      ASSERT_EQ(value, values[i]) << channels << " channels, number " << i;
    }
  }
}

}  // namespace exr_test
}  // namespace supple
