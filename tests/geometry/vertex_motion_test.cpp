// Tests that the motions of surfaces are read from all kinds of files alike, and which files are refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "base/error.h"
#include "geometry/files/vertex_motion.h"
#include "support/bodies.h"
#include "support/motion_files.h"
#include "support/surfaces.h"
#include "support/text_file.h"

namespace supple {
namespace vertex_motion_test {

// Coordinates that single precision holds.
std::vector<Positions> three_frames() {
  std::vector<Positions> frames;
  for (int f = 0; f < 3; ++f) {
    Positions& frame = frames.emplace_back(4, 3);
    for (Eigen::Index i = 0; i < frame.size(); ++i) frame.data()[i] = 0.25 * double(i) - 0.5 * f * double(i % 5);
  }
  return frames;
}

class VertexMotions : public testing::Test {
 protected:
  test::TemporaryFolder folder;

  std::filesystem::path written(const std::string& name, const std::string& bytes) const {
    test::write_text(folder.path / name, bytes);
    return folder.path / name;
  }
  static std::string refusal(const std::filesystem::path& path, const std::string& body = "") {
    try {
      (void)read_vertex_motion(path, body);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
};

TEST_F(VertexMotions, AllKindsOfFilesReadBackEqual) {
  const std::vector<Positions> frames = three_frames();
  Triangles triangles(1, 3);
  triangles << 0, 1, 2;
  for (std::size_t f = 0; f < frames.size(); ++f)
    written(fmt::format("walk_{:04}.obj", 8 + 2 * f), test::obj_text({frames[f], triangles}));
  written("run/motion/blob.pc2", test::pc2_bytes(frames));
  const std::vector<std::filesystem::path> all = {written("walk.pc2", test::pc2_bytes(frames)),
                                                  written("walk.mdd", test::mdd_bytes(frames)),
                                                  folder.path / "walk_*.obj", folder.path / "run"};
  for (const std::filesystem::path& path : all) {
    EXPECT_TRUE(is_motion_there(path)) << path;
    const VertexMotion motion = read_vertex_motion(path, "blob");
    ASSERT_EQ(motion.frames.size(), 3u) << path;
    for (std::size_t f = 0; f < 3; ++f) EXPECT_EQ(motion.frames[f], frames[f]) << path << " " << f;
    EXPECT_EQ(source_of(motion).hash, source_of(read_vertex_motion(all.front(), "")).hash);
  }
  EXPECT_FALSE(is_motion_there(folder.path / "run_*.obj"));
}

TEST_F(VertexMotions, BadFilesAreRefusedByName) {
  const std::vector<Positions> frames = three_frames();
  const std::string pc2 = test::pc2_bytes(frames), mdd = test::mdd_bytes(frames);
  const auto expect = [&](const std::filesystem::path& path, const std::string& text) {
    const std::string said = refusal(path, "body");
    EXPECT_NE(said.find(path.filename().string()), std::string::npos) << said;
    EXPECT_NE(said.find(text), std::string::npos) << said;
  };
  expect(written("short.pc2", pc2.substr(0, pc2.size() - 1)),
         "is cut short: it holds 175 bytes, and 3 frames of 4 points need 176");
  expect(written("long.pc2", pc2 + std::string(49, 'x')), "is damaged");
  expect(written("head.pc2", pc2.substr(0, 20)), "header of 32 bytes");
  expect(written("other.pc2", std::string(100, 'x')), "does not begin with 'POINTCACHE2'");
  std::string swapped = pc2;
  std::swap(swapped[12], swapped[15]);
  expect(written("swapped.pc2", swapped), "PC2 point caches are little-endian");
  expect(written("swapped.mdd", test::mdd_bytes(frames, true)), "MDD point caches are big-endian");
  expect(written("short.mdd", mdd.substr(0, mdd.size() - 4)), "is cut short");
  expect(written("none.mdd", mdd.substr(0, 3)), "begins with two counts");
  std::vector<Positions> broken = frames;
  broken[1](2, 1) = std::numeric_limits<double>::quiet_NaN();
  expect(written("nan.pc2", test::pc2_bytes(broken)), "a number of frame 1 is not finite");
  expect(written("nan.mdd", test::mdd_bytes(broken)), "a number of frame 1 is not finite");
  expect(written("walk.abc", "x"), "is no motion: must be a .pc2 or .mdd point cache");
  written("a_1.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  written("a_2.obj", "v 0 0 0\n");
  EXPECT_NE(refusal(folder.path / "a_*.obj").find("a_2.obj: has 1 vertices, and 'a_1.obj' has 3"), std::string::npos);
  for (const int number : {1, 2, 4}) written(fmt::format("b_{}.obj", number), "v 0 0 0\n");
  expect(folder.path / "b_*.obj", "the file of number 3 is missing");
  written("run/motion/ball.pc2", pc2);
  expect(folder.path / "run", "has no motion of a body 'body': there is ball");
}

}  // namespace vertex_motion_test
}  // namespace supple
