// Tests the normals of drawn surfaces.
#include <gtest/gtest.h>

#include "render/view.h"

namespace supple {
namespace normals_test {

// Two sides of a roof, whose ridge has vertices 0 and 1 on the left side and 3 and 4 on the right one.
const std::vector<float> roof = {0, 1, 0, 0, 1, 1, -1, 0, 0, 0, 1, 0, 0, 1, 1, 1, 0, 0};
const std::vector<std::uint32_t> sides = {0, 2, 1, 3, 4, 5};

TEST(Normals, VerticesThatColoursSplitHaveOne) {
  std::vector<float> own(4 * 6), shared(4 * 6);
  compute_normals(roof, sides, {}, own.data());
  compute_normals(roof, sides, {7, 3, 0, 7, 3, 1}, shared.data());
  for (const std::size_t v : {0u, 1u}) {
    EXPECT_LT(own[4 * v], -0.7f);
    EXPECT_NEAR(shared[4 * v], 0, 1e-6);
    EXPECT_NEAR(shared[4 * v + 1], 1, 1e-6);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(shared[4 * v + k], shared[4 * (v + 3) + k]);
  }
  for (const std::size_t v : {2u, 5u})
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(shared[4 * v + k], own[4 * v + k]);
}

}  // namespace normals_test
}  // namespace supple
