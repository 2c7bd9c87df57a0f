// Tests the file that keeps the forces of colliders, whole, continued, cut short and damaged.
#include "output/motion/force_file.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "support/bodies.h"

namespace supple {
namespace force_file_test {

constexpr int vertices = 6;

// Returns forces on vertices 1 and 4, which differ from frame to frame.
Positions forces_at(int frame) {
  Positions forces = Positions::Zero(vertices, 3);
  forces.row(1) << 0.1, 2.0 + frame, -3;
  if (frame % 2 == 0) forces.row(4) << 0, 1e-7, 0;
  return forces;
}

class ForceFile : public testing::Test {
 protected:
  std::filesystem::path write(int frames) const {
    ForceFileWriter writer(path(), vertices);
    for (int frame = 0; frame < frames; ++frame) writer.add(forces_at(frame));
    return path();
  }
  std::filesystem::path path() const { return folder_.path / "body.forces"; }
  // Writes a number over the file.
  template <class T>
  void put(std::int64_t at, T value) const {
    std::fstream file(path(), std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(at);
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(ForceFile, GivesBackWhatItWasGivenInSinglePrecision) {
  ForceFileReader reader(write(3));
  EXPECT_EQ(reader.vertices(), vertices);
  ASSERT_EQ(reader.frames(), 3);
  for (const int frame : {2, 0, 1}) EXPECT_EQ(reader.frame(frame), as_kept_forces(forces_at(frame)));
}

TEST_F(ForceFile, TakesRoomForVerticesWithAForceAlone) {
  write(2);
  EXPECT_EQ(std::filesystem::file_size(path()), 16u + (4 + 2 * 16) + (4 + 16));
}

TEST_F(ForceFile, GoesOnAfterTheFramesThatAreKept) {
  write(5);
  {
    ForceFileWriter writer(path(), vertices, 2);
    writer.add(forces_at(7));
  }
  ForceFileReader reader(path());
  ASSERT_EQ(reader.frames(), 3);
  EXPECT_EQ(reader.frame(1), as_kept_forces(forces_at(1)));
  EXPECT_EQ(reader.frame(2), as_kept_forces(forces_at(7)));
  EXPECT_THROW(ForceFileWriter(path(), vertices, 4), RunError);
  EXPECT_THROW(ForceFileWriter(path(), vertices + 1, 2), RunError);
  EXPECT_TRUE(force_file_has(path(), vertices, 3));
  EXPECT_FALSE(force_file_has(path(), vertices, 4));
  EXPECT_FALSE(force_file_has(path(), vertices + 1, 3));
}

TEST_F(ForceFile, LeavesOutAFrameThatWasCutShort) {
  write(3);
  std::filesystem::resize_file(path(), std::filesystem::file_size(path()) - 1);
  EXPECT_EQ(ForceFileReader(path()).frames(), 2);
}

TEST_F(ForceFile, RefusesWhatIsDamaged) {
  EXPECT_THROW(ForceFileReader(path() / "none"), InputError);
  constexpr std::int64_t first_vertex = 20, second_vertex = 36, first_force = 24;
  write(1);
  put(second_vertex, std::int32_t(vertices));
  EXPECT_THROW(ForceFileReader(path()).frame(0), InputError);
  put(second_vertex, std::int32_t(1));
  EXPECT_THROW(ForceFileReader(path()).frame(0), InputError) << "a vertex comes twice";
  write(1);
  put(first_vertex, std::int32_t(-1));
  EXPECT_THROW(ForceFileReader(path()).frame(0), InputError);
  write(1);
  put(first_force, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THROW(ForceFileReader(path()).frame(0), InputError);
  write(1);
  put(0, 'X');
  EXPECT_THROW(ForceFileReader{path()}, InputError);
  write(1);
  put(16, std::int32_t(vertices + 1));
  EXPECT_EQ(ForceFileReader(path()).frames(), 0);
}

}  // namespace force_file_test
}  // namespace supple
