// Tests the painted layers of surfaces.
#include <gtest/gtest.h>

#include <algorithm>

#include "output/files/png_file.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace paint_test {

// Returns how many pixels differ from all around them, where these are alike.
int specks(const PngImage& image) {
  const auto green = [&](int x, int y) { return int(image.rgb[3 * std::size_t(y * image.width + x) + 1]); };
  int count = 0;
  for (int y = 1; y + 1 < image.height; ++y) {
    for (int x = 1; x + 1 < image.width; ++x) {
      int low = 255, high = 0;
      for (const auto& [right, up] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, 1}, {-1, 1}, {1, -1}}) {
        low = std::min(low, green(x + right, y + up));
        high = std::max(high, green(x + right, y + up));
      }
      if (high - low < 8 && (green(x, y) < low - 8 || green(x, y) > high + 8)) ++count;
    }
  }
  return count;
}

// Where a fine skin was made coarser, it has triangles that are next to nothing high, whose weights are wild.
TEST(Paint, HasNoBordersOnThinTrianglesBesideThem) {
  const test::TemporaryFolder folder;
  // The rail is hidden, because the border of its shadow has specks of its own.
  const test::Result made =
      test::run(folder.path, {"render", "dented-cans", "--frames", "1", "--no-video", "--out", "cans", "--set",
                              "body.tin.skin_cells=150", "--set", "body.rubber.skin_cells=150", "--set",
                              "collider.rail.visible=false"});
  ASSERT_EQ(made.status, 0) << made.err;
  // Wild weights made hundreds. Four are left, where the normal of such a triangle makes it lighter or darker.
  EXPECT_LT(specks(read_png(folder.path / "cans" / "frames" / "000000.png")), 10);
}

}  // namespace paint_test
}  // namespace supple
