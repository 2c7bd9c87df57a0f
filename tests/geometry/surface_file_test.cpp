// Tests surfaces as they come from outside: they are repaired, or refused with the name of the triangle. Files that are
// broken in any way must neither end this process nor be accepted.
#include "geometry/files/surface_file.h"
#include "geometry/solids/closed_surface.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <Eigen/LU>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

#include "base/error.h"
#include "geometry/files/reader_process.h"
#include "geometry/solids/triangle_solid.h"
#include "support/bodies.h"
#include "support/surfaces.h"

namespace supple {
namespace surface_file_test {

using Notes = std::vector<std::string>;

// Returns what is wrong, without the file's name, or nothing when the surface is accepted.
template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
    return "";
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems().size(), 1u);
    EXPECT_EQ(error.problems()[0].message.find('\n'), std::string::npos);
    return error.problems()[0].message;
  }
}

std::string refusal_of(const TriMesh& mesh) {
  return refusal([&] { closed_surface(mesh, "x", nullptr); });
}
std::string refusal_of(const std::filesystem::path& path) {
  return refusal([&] { read_closed_surface(path, nullptr); });
}

void expect_refusal(const std::string& found, const std::string& part) {
  EXPECT_NE(found.find(part), std::string::npos) << "found: '" << found << "', expected: '" << part << "'";
}

// Compares the corners in order, whatever the numbers of the vertices.
void expect_same_triangles(const TriMesh& found, const TriMesh& expected, double tolerance) {
  ASSERT_EQ(found.triangles.rows(), expected.triangles.rows());
  double worst = 0;
  for (Eigen::Index t = 0; t < found.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      worst = std::max(worst, (found.points.row(found.triangles(t, k)) - expected.points.row(expected.triangles(t, k)))
                                  .cwiseAbs()
                                  .maxCoeff());
  EXPECT_LE(worst, tolerance);
}

TEST(ClosedSurface, LeavesAGoodSurfaceAsItIsWithoutAWord) {
  Notes notes;
  const TriMesh ring = test::torus_surface(1, 0.4, 20, 10);
  const TriMesh found = closed_surface(ring, "ring", &notes);
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(found.points.rows(), ring.points.rows());
  expect_same_triangles(found, ring, 0);
}

TEST(ClosedSurface, MergesEqualPositionsAndDropsUnusedVertices) {
  const TriMesh ball = test::sphere_surface(1, 12, 6);
  TriMesh soup{Positions(3 * ball.triangles.rows() + 1, 3), Triangles(ball.triangles.rows(), 3)};
  for (Eigen::Index t = 0; t < ball.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      soup.points.row(3 * t + k) = ball.points.row(ball.triangles(t, k));
      soup.triangles(t, k) = std::int32_t(3 * t + k);
    }
  }
  soup.points.bottomRows(1).setConstant(std::numeric_limits<double>::quiet_NaN());  // no triangle names it
  Notes notes;
  const TriMesh found = closed_surface(soup, "soup", &notes);
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(found.points.rows(), ball.points.rows());
  expect_same_triangles(found, ball, 0);
}

TEST(ClosedSurface, LeavesOutFlatAndRepeatedTrianglesAndSaysHowMany) {
  TriMesh box = test::box_surface(Vec3(1, 1, 1));
  const Triangles good = box.triangles;
  box.triangles.resize(16, 3);
  box.triangles << good, Triangles{{0, 4, 4}, {6, 0, 4}, {0, 6, 4}, {1, 3, 7}};
  Notes notes;
  const TriMesh found = closed_surface(box, "box", &notes);
  EXPECT_EQ(found.triangles.rows(), 12);
  EXPECT_EQ(notes, (Notes{"1 triangles without area were left out", "3 triangles that repeat others were left out"}));
}

TEST(ClosedSurface, TurnsAllTrianglesOutward) {
  const TriMesh ring = test::torus_surface(1, 0.4, 20, 10);
  TriMesh shaken = ring;
  std::mt19937 random(8);
  int turned = 0;
  for (Eigen::Index t = 0; t < ring.triangles.rows(); ++t) {
    if (random() % 3 != 0) continue;
    std::swap(shaken.triangles(t, 1), shaken.triangles(t, 2));
    ++turned;
  }
  Notes notes;
  EXPECT_DOUBLE_EQ(test::six_volumes(closed_surface(shaken, "ring", &notes)), test::six_volumes(ring));
  EXPECT_EQ(notes, Notes{fmt::format("{} of 400 triangles were turned to face outward", turned)});
  notes.clear();
  EXPECT_DOUBLE_EQ(test::six_volumes(closed_surface(test::inside_out(ring), "ring", &notes)), test::six_volumes(ring));
  EXPECT_EQ(notes, Notes{"400 of 400 triangles were turned to face outward"});
}

TEST(ClosedSurface, KeepsCavitiesAndUnitesWhatIsTurnedAlike) {
  const TriMesh ball = test::sphere_surface(1, 16, 8);
  const auto scaled = [&](double by) { return TriMesh{by * ball.points, ball.triangles}; };
  const TriMesh shell = test::together(test::inside_out(scaled(0.5)), ball), core = test::together(shell, scaled(0.2));
  const double whole = test::six_volumes(ball);
  Notes notes;
  const auto volume = [&](const TriMesh& mesh) { return test::six_volumes(closed_surface(mesh, "x", &notes)) / whole; };
  EXPECT_NEAR(volume(shell), 1 - 0.125, 1e-12);
  EXPECT_NEAR(volume(core), 1 - 0.125 + 0.008, 1e-12);
  EXPECT_TRUE(notes.empty());
  // These are the same files with all triangles flipped.
  EXPECT_NEAR(volume(test::inside_out(shell)), 1 - 0.125, 1e-12);
  EXPECT_NEAR(volume(test::inside_out(core)), 1 - 0.125 + 0.008, 1e-12);
  EXPECT_EQ(notes.size(), 2u);
  // The majority of a component's triangles decides, not the first one.
  TriMesh first_turned = shell;
  std::swap(first_turned.triangles(0, 1), first_turned.triangles(0, 2));
  EXPECT_NEAR(volume(first_turned), 1 - 0.125, 1e-12);
  // A component inside the box of a ring but outside the ring is not a cavity.
  const TriMesh ring = test::torus_surface(1, 0.4, 20, 10), ball_in_ring = test::inside_out(scaled(0.1));
  EXPECT_NEAR(volume(test::together(ring, ball_in_ring)), volume(ring) + 0.001, 1e-12);
  // A solid inside another, a solid beside another, and one that only overlaps it all face outward.
  EXPECT_NEAR(volume(test::together(ball, scaled(0.5))), 1.125, 1e-12);
  EXPECT_NEAR(volume(test::together(ball, test::moved(test::inside_out(scaled(0.5)), Vec3(3, 0, 0)))), 1.125, 1e-12);
  EXPECT_NEAR(volume(test::together(ball, test::moved(test::inside_out(scaled(0.5)), Vec3(0.8, 0, 0)))), 1.125, 1e-12);
}

TEST(ClosedSurface, ToleratesASmallHoleWithANote) {
  Notes notes;
  const TriMesh found = closed_surface(test::without_triangle(test::sphere_surface(1, 20, 10), 100), "ball", &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "3 open edges around 1 holes, of up to 0.32 % of the area: taken as closed");
  EXPECT_LT(TriangleSolid(found).closest(Vec3::Zero()).distance, -0.9);
}

TEST(ClosedSurface, RefusesWhatHasNoInsideAndNamesATriangle) {
  const TriMesh box = test::box_surface(Vec3(1, 1, 1));
  expect_refusal(refusal_of(test::without_triangle(box, 4)), "the surface is open: holes of 9.0");
  expect_refusal(refusal_of(test::without_triangle(box, 4)), "at triangle ");
  TriMesh sheet{box.points, Triangles{{0, 1, 5}, {0, 5, 4}}};
  expect_refusal(refusal_of(sheet), "the surface is open: holes of 100 % of its area, the largest at triangle 2 at (");
  TriMesh cup = test::sphere_surface(1, 20, 10);  // only the lower half is kept
  cup.triangles.conservativeResize(180, 3);
  expect_refusal(refusal_of(cup), "the surface is open");
  // The area vectors at the ends of three quarters of a ring do not cancel.
  TriMesh tube = test::torus_surface(1, 0.2, 20, 10);
  tube.triangles.conservativeResize(300, 3);
  expect_refusal(refusal_of(tube), "the surface is open");
  // A sound surface beside an open one does not hide it.
  expect_refusal(refusal_of(test::together(test::sphere_surface(100, 20, 10), sheet)), "at triangle 362 at (");

  TriMesh fin = box;
  fin.triangles.conservativeResize(13, 3);
  fin.points.conservativeResize(9, 3);
  fin.points.row(8) << -5, -5, -5;
  fin.triangles.row(12) << 0, 1, 8;
  expect_refusal(refusal_of(fin), "three triangles or more share an edge, among them triangle 13 at (");

  TriMesh strip{Positions(12, 3), Triangles(12, 3)};  // a strip with half a turn in six steps
  for (int i = 0; i < 6; ++i) {
    const double s = i * std::numbers::pi / 3;
    const Vec3 out(std::cos(s), 0, std::sin(s)),
        across = 0.3 * (std::cos(s / 2) * Vec3::UnitY() + std::sin(s / 2) * out);
    strip.points.row(2 * i) = (out + across).transpose();
    strip.points.row(2 * i + 1) = (out - across).transpose();
    const bool last = i == 5;
    const int a = 2 * i, b = 2 * i + 1, c = last ? 1 : 2 * i + 2, d = last ? 0 : 2 * i + 3;
    strip.triangles.row(2 * i) << a, b, c;
    strip.triangles.row(2 * i + 1) << c, b, d;
  }
  expect_refusal(refusal_of(strip), "one-sided, like a Moebius strip: no inside at triangle ");

  TriMesh bad = box;
  bad.points(5, 1) = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(refusal_of(bad), "vertex 3 of triangle 4 is not finite: (1, nan, 1)");
  bad.points(5, 1) = 1e60;
  expect_refusal(refusal_of(bad), "vertex 3 of triangle 4 is beyond 1e50");
  bad = box;
  bad.triangles(7, 2) = 8;
  expect_refusal(refusal_of(bad), "triangle 8 names vertex 8, but there are 8 (counted from 0)");
  expect_refusal(refusal_of(TriMesh{box.points, Triangles(0, 3)}), "has no triangles");
  expect_refusal(refusal_of(TriMesh{box.points, Triangles{{0, 0, 1}}}), "has no triangle with an area");
}

// These functions write the formats by hand.
std::string obj_text(const TriMesh& mesh) {
  std::string text;
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v)
    text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", mesh.points(v, 0), mesh.points(v, 1), mesh.points(v, 2));
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    text += fmt::format("f {} {} {}\n", mesh.triangles(t, 0) + 1, mesh.triangles(t, 1) + 1, mesh.triangles(t, 2) + 1);
  return text;
}

std::string ply_header(const char* format, long long vertices, long long faces) {
  return fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      format, vertices, faces);
}

std::string ply_text(const TriMesh& mesh) {
  std::string text = ply_header("ascii", mesh.points.rows(), mesh.triangles.rows());
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v)
    text += fmt::format("{:.9g} {:.9g} {:.9g}\n", mesh.points(v, 0), mesh.points(v, 1), mesh.points(v, 2));
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    text += fmt::format("3 {} {} {}\n", mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2));
  return text;
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string ply_bytes(const TriMesh& mesh) {
  std::string bytes = ply_header("binary_little_endian", mesh.points.rows(), mesh.triangles.rows());
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v)
    for (int k = 0; k < 3; ++k) append(bytes, float(mesh.points(v, k)));
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    append(bytes, std::uint8_t(3));
    for (int k = 0; k < 3; ++k) append(bytes, mesh.triangles(t, k));
  }
  return bytes;
}

std::string stl_bytes(const TriMesh& mesh, std::uint32_t count) {
  std::string bytes(80, ' ');
  append(bytes, count);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) append(bytes, 0.0f);
    for (int k = 0; k < 9; ++k) append(bytes, float(mesh.points(mesh.triangles(t, k / 3), k % 3)));
    append(bytes, std::uint16_t(0));
  }
  return bytes;
}

class SurfaceFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path / name, std::ios::binary) << bytes;
    return folder_.path / name;
  }

  // Broken bytes are refused in words or happen to be a closed surface; no child process is left.
  void expect_survived(const std::string& name, const std::string& bytes) const {
    const std::string said = refusal_of(write(name, bytes));
    EXPECT_LT(said.size(), 400u);
    refused_ += !said.empty();
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
  }

  test::TemporaryFolder folder_;
  TriMesh ring_ = test::torus_surface(1, 0.4, 12, 8);
  mutable int refused_ = 0;
};

TEST_F(SurfaceFile, ReadsTheSameSurfaceFromEachFormat) {
  const std::filesystem::path files[] = {write("a.obj", obj_text(ring_)), write("b.ply", ply_text(ring_)),
                                         write("c.ply", ply_bytes(ring_)), write("d.stl", stl_bytes(ring_, 192))};
  for (const std::filesystem::path& file : files) {
    Notes notes;
    const TriMesh found = read_closed_surface(file, &notes);
    EXPECT_TRUE(notes.empty()) << file << ": " << notes[0];
    EXPECT_EQ(found.points.rows(), ring_.points.rows()) << file;
    expect_same_triangles(found, ring_, 2e-7);  // files hold floats
  }
}

TEST_F(SurfaceFile, CutsPolygonsAndAppliesTheTransformsOfNodes) {
  const std::filesystem::path off =
      write("box.off",
            "OFF\n8 6 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n4 0 4 6 2\n4 1 3 7 5\n4 0 1 5 4\n"
            "4 2 6 7 3\n4 0 2 3 1\n4 4 5 7 6\n");
  EXPECT_NEAR(test::six_volumes(read_closed_surface(off, nullptr)), 6, 1e-6);
  std::string buffer;
  const TriMesh box = test::box_surface(Vec3(1, 1, 1));
  for (const double x : box.points.reshaped<Eigen::RowMajor>()) append(buffer, float(x));
  for (const std::int32_t v : box.triangles.reshaped<Eigen::RowMajor>()) append(buffer, std::uint16_t(v));
  write("box.bin", buffer);
  const std::filesystem::path gltf = write("box.gltf",
                                           R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0, "translation": [10, 0, 0], "scale": [2, 1, 1]}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
"buffers": [{"uri": "box.bin", "byteLength": 168}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-1, -1, -1], "max": [1, 1, 1]},
{"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]})");
  const TriMesh found = read_closed_surface(gltf, nullptr);
  EXPECT_NEAR(test::six_volumes(found), 6 * 16, 1e-5);
  EXPECT_NEAR(bounds_of(found.points).center().x(), 10, 1e-6);
}

TEST_F(SurfaceFile, RefusesWhatIsNoFileOfThatKind) {
  expect_refusal(refusal_of(folder_.path / "none.obj"), "no such file");
  expect_refusal(refusal_of(folder_.path), "is a directory");
  expect_refusal(refusal_of(write("empty.stl", "")), "is empty");
  ASSERT_EQ(::mkfifo((folder_.path / "pipe.obj").c_str(), 0600), 0);
  expect_refusal(refusal_of(folder_.path / "pipe.obj"), "is not a file");
  std::filesystem::resize_file(write("large.stl", "solid"), std::uintmax_t(3) << 30);
  expect_refusal(refusal_of(folder_.path / "large.stl"), "is larger than 1 GiB");
  expect_refusal(refusal_of(write("text.xyz", "hello")), "cannot be read: ");
  expect_refusal(refusal_of(write("none.stl", stl_bytes(TriMesh{}, 0))), "cannot be read: ");
  expect_refusal(refusal_of(write("points.obj", "v 0 0 0\nv 1 0 0\n")), "the file has 2 vertices, and no faces");
  std::string nan = obj_text(ring_);
  nan.replace(0, nan.find('\n'), "v nan 0 0");
  expect_refusal(refusal_of(write("nan.obj", nan)), "a coordinate is not finite: nan");
}

TEST_F(SurfaceFile, SurvivesHeadersThatClaimGigabytes) {
  const ColoredSurface closed = read_colored_surface(write("many.stl", stl_bytes(ring_, 0xFFFFFFFFu)));
  EXPECT_EQ(closed.mesh.triangles.rows(), 192);
  ASSERT_EQ(closed.remarks.size(), 1u);
  EXPECT_EQ(closed.remarks[0], "4294967295 facets announced, but the file has 192; those are closed, and are read");
  expect_refusal(refusal_of(write("many.stl", stl_bytes(test::without_triangle(ring_, 7), 0xFFFFFFFFu))),
                 "4294967295 facets announced, but the file has 191");
}

// The reader would take memory for what is announced, and seek the end of a header until its time is up.
TEST_F(SurfaceFile, RefusesHeadersThatAnnounceMoreThanTheFileHolds) {
  const std::string vertex = ply_header("binary_little_endian", 100'000'000, 1) + std::string(100, 'x');
  expect_refusal(refusal_of(write("many.ply", vertex)),
                 fmt::format("announces 100000000 of 'vertex', for which its {} bytes have no room", vertex.size()));
  const std::string face = ply_header("ascii", 1, 2'000'000'000) + "0 0 0\n";
  expect_refusal(refusal_of(write("faces.ply", face)), "announces 2000000000 of 'face', for which its ");
  const std::string endless = ply_header("ascii", 3, 1);
  expect_refusal(refusal_of(write("endless.ply", endless.substr(0, endless.find("end_header")))),
                 "has a header without an end (end_header)");
  expect_refusal(refusal_of(write("many.off", "OFF # corners\n\n100000000 1 0\n0 0 0\n")),
                 "announces 100000000 vertices, for which its 35 bytes have no room");
  expect_refusal(refusal_of(write("faces.off", "OFF 3 100000000 0\n0 0 0\n")),
                 "announces 100000000 faces, for which its ");
}

TEST_F(SurfaceFile, SurvivesTruncatedAndCorruptedFiles) {
  const std::string bytes = ply_bytes(ring_), text = ply_text(ring_);
  int cuts = 1;
  expect_survived("cut.ply", bytes.substr(0, 100));  // cut in the header
  for (std::size_t length = 172; length < bytes.size(); length += length < 300 ? 23 : 311, ++cuts)
    expect_survived("cut.ply", bytes.substr(0, length));
  for (std::size_t length = 165; length < text.size() - 20; length += 397, ++cuts)
    expect_survived("cut.ply", text.substr(0, length));
  EXPECT_EQ(refused_, cuts);
  std::mt19937 random(9);
  for (const std::string& whole : {bytes, text, stl_bytes(ring_, 192), obj_text(ring_)}) {
    const std::string name = whole == bytes || whole == text ? "bad.ply" : whole[0] == 'v' ? "bad.obj" : "bad.stl";
    for (int i = 0; i < 10; ++i) {
      std::string bad = whole;
      for (int k = 0; k < 4; ++k) bad[random() % bad.size()] = char(random());
      expect_survived(name, bad);
    }
  }
  EXPECT_GT(refused_, cuts);
}

TEST_F(SurfaceFile, AReaderThatCrashesHangsFailsOrFloodsIsRefusedAndGone) {
  const auto script = [&](const std::string& commands) {
    const std::filesystem::path path = write("reader", "#!/bin/sh\n" + commands + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  };
  const auto says = [&](const std::string& commands, const ReaderLimits& limits) {
    return refusal([&] { run_reader(script(commands), "file", limits); });
  };
  EXPECT_EQ(run_reader(script("printf \"$1\""), "file"), "file");
  EXPECT_EQ(says("kill -SEGV $$", {}), "is broken: its reader crashed (signal 11)");
  EXPECT_EQ(says("exit 3", {}), "is broken: its reader failed (status 3)");
  EXPECT_EQ(says("kill -XCPU $$", {}),
            "takes too long to read: its reader may compute for 3 s, and 2 s for each MB of the file");
  EXPECT_EQ(says("kill -KILL $$", {}), "cannot be read: its reader was killed; is memory short?");
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(says("exec sleep 100", {.seconds = 0.2}), "takes too long to read: more than 0.2 s");
  EXPECT_EQ(says("exec sleep 100 >&-", {.seconds = 0.2}),
            "takes too long to read: more than 0.2 s");  // output closed, yet it lives
  EXPECT_EQ(says("exec cat /dev/zero", {.bytes = 3 << 20}), "holds more than 3 MB of triangles");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(50));
  EXPECT_EQ(refusal([&] { run_reader(folder_.path / "none", "file"); }),
            fmt::format("cannot be read: {}: No such file or directory", (folder_.path / "none").string()));
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

}  // namespace surface_file_test
}  // namespace supple
