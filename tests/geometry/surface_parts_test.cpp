// Tests what is read of a file's parts: their names in OBJ and glTF, and the texture coordinates of their vertices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "geometry/files/surface_file.h"
#include "geometry/skins/file_corners.h"
#include "support/bodies.h"
#include "support/colored_files.h"

namespace supple {
namespace surface_parts_test {

using Names = std::vector<std::string>;

class SurfaceFiles : public ::testing::Test {
 protected:
  ColoredSurface read(const std::string& name, const std::string& text) const {
    test::write_text(folder_.path / name, text);
    return read_colored_surface(folder_.path / name);
  }
  test::TemporaryFolder folder_;
};

// Returns the names of the triangle whose corners have this middle.
Names names_at(const ColoredSurface& surface, const Vec3& middle) {
  for (Eigen::Index t = 0; t < surface.mesh.triangles.rows(); ++t) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k) sum += surface.mesh.points.row(surface.mesh.triangles(t, k)).transpose();
    if ((sum / 3 - middle).norm() < 1e-5)
      return surface.parts.names[std::size_t(surface.parts.of[std::size_t(surface.mesh.triangles(t, 0))])];
  }
  return {"no such triangle"};
}

// Returns triangles side by side along x, each after lines of its own.
std::string squares_obj(const Names& lines_before_faces) {
  std::string vertices, faces;
  for (std::size_t i = 0; i < lines_before_faces.size(); ++i) {
    vertices += fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} 1 0\n", 2 * i, 2 * i + 1);
    faces += lines_before_faces[i] + fmt::format("\nf {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
  }
  return vertices + faces;
}

Vec3 middle_of(int square) { return Vec3(2 * square + 1.0 / 3, 1.0 / 3, 0); }

TEST_F(SurfaceFiles, AnObjFileNamesObjectsGroupsAndMaterials) {
  const ColoredSurface surface =
      read("a.obj", squares_obj({"g left sleeve", "g collar\nusemtl my red", "g left sleeve\nusemtl blue",
                                 "o long dress", "g hem", "usemtl green", "g \"quoted name\""}));
  EXPECT_EQ(names_at(surface, middle_of(0)), Names({"left sleeve"}));
  EXPECT_EQ(names_at(surface, middle_of(1)), Names({"my red", "collar"}));
  EXPECT_EQ(names_at(surface, middle_of(2)), Names({"blue", "left sleeve"}));
  EXPECT_EQ(names_at(surface, middle_of(3)), Names({"blue", "long dress"}));
  EXPECT_EQ(names_at(surface, middle_of(4)), Names({"blue", "long dress", "hem"}));
  EXPECT_EQ(names_at(surface, middle_of(5)), Names({"green", "long dress", "hem"}));
  EXPECT_EQ(names_at(surface, middle_of(6)), Names({"green", "long dress", "\"quoted name\""}));
}

TEST_F(SurfaceFiles, AnObjectThatIsNamedAgainHasItsFacesAgain) {
  const ColoredSurface surface = read("a.obj", squares_obj({"o dress", "o belt", "o dress", "g hem", "o belt"}));
  EXPECT_EQ(names_at(surface, middle_of(0)), Names({"dress"}));
  EXPECT_EQ(names_at(surface, middle_of(1)), Names({"belt"}));
  EXPECT_EQ(names_at(surface, middle_of(2)), Names({"dress"}));
  EXPECT_EQ(names_at(surface, middle_of(3)), Names({"dress", "hem"}));
  EXPECT_EQ(names_at(surface, middle_of(4)), Names({"belt"}));
}

TEST_F(SurfaceFiles, AFileWithoutNamesHasNoParts) {
  EXPECT_TRUE(read("a.obj", squares_obj({"", ""})).parts.of.empty());
  const TriMesh ball = test::sphere_surface(1, 8, 4);
  const ColoredSurface ply = read("a.ply", test::ply_text(ball, [](const Vec3&) { return std::array{1, 2, 3}; }));
  EXPECT_TRUE(ply.parts.of.empty());
  EXPECT_TRUE(ply.parts.names.empty());
  EXPECT_TRUE(ply.places.empty());
}

// Changes the text of a glTF file that is one square with a texture: the square becomes two instances of a mesh.
std::string two_panels() {
  const TriMesh square{(Positions(4, 3) << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0).finished(),
                       (Triangles(2, 3) << 0, 1, 2, 0, 2, 3).finished()};
  std::string glb = test::glb_text(square, {{{0, 1}, {1, 1}, {1, 0}, {0, 0}}}, "", {{"name", "blue silk"}});
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  nlohmann::json text = nlohmann::json::parse(glb.substr(20, length));
  text.erase("textures");
  text.erase("images");
  text["scenes"] = {{{"nodes", {0, 1}}}};
  text["nodes"] = {{{"name", "front"}, {"children", {2}}},
                   {{"name", "back"}, {"mesh", 0}, {"translation", {4, 0, 0}}},
                   {{"name", "front panel"}, {"mesh", 0}}};
  text["meshes"][0]["name"] = "panel";
  std::string head = text.dump();
  head.resize((head.size() + 3) / 4 * 4, ' ');
  const std::string rest = glb.substr(20 + length);
  const std::uint32_t lengths[2] = {std::uint32_t(20 + head.size() + rest.size()), std::uint32_t(head.size())};
  std::string file = glb.substr(0, 20);
  std::memcpy(file.data() + 8, &lengths[0], 4);
  std::memcpy(file.data() + 12, &lengths[1], 4);
  return file + head + rest;
}

TEST_F(SurfaceFiles, AGltfFileNamesNodesMeshesAndMaterialsAlsoWhereAMeshIsThereTwice) {
  const ColoredSurface surface = read("a.glb", two_panels());
  ASSERT_EQ(surface.mesh.triangles.rows(), 4);
  EXPECT_EQ(names_at(surface, Vec3(2.0 / 3, 1.0 / 3, 0)), Names({"blue silk", "panel", "front", "front panel"}));
  EXPECT_EQ(names_at(surface, Vec3(4 + 2.0 / 3, 1.0 / 3, 0)), Names({"blue silk", "panel", "back"}));
  ASSERT_EQ(Eigen::Index(surface.places.size()), surface.mesh.points.rows());
  for (Eigen::Index v = 0; v < surface.mesh.points.rows();
       ++v) {  // v counts from the lower edge, in glTF from the upper
    EXPECT_NEAR(surface.places[std::size_t(v)][0], std::fmod(surface.mesh.points(v, 0), 4), 1e-6);
    EXPECT_NEAR(surface.places[std::size_t(v)][1], surface.mesh.points(v, 1), 1e-6);
  }
}

TEST_F(SurfaceFiles, TextureCoordinatesAreReadWithoutATextureAndMissingOnesAreNoNumbers) {
  const ColoredSurface surface = read("a.obj",
                                      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 3 4\nvt 5 4\nvt 3 7\ng a\nf 1/1 2/2 3/3\n"
                                      "v 5 0 0\nv 6 0 0\nv 5 1 0\ng b\nf 4 5 6\n");
  ASSERT_EQ(surface.places.size(), 6u);
  for (Eigen::Index v = 0; v < 6; ++v) {
    const Vec3 p = surface.mesh.points.row(v);
    const TexturePlace& place = surface.places[std::size_t(v)];
    if (p.x() > 4) {
      EXPECT_TRUE(std::isnan(place[0]) && std::isnan(place[1]));
    } else {
      EXPECT_NEAR(place[0], 3 + 2 * p.x(), 1e-6);
      EXPECT_NEAR(place[1], 4 + 3 * p.y(), 1e-6);
    }
  }
}

TEST_F(SurfaceFiles, CornersKnowTheirPlaceInTheFileAfterWeldingAndRemeshing) {
  // Two squares that share a side, and whose texture jumps there.
  const ColoredSurface file = read("a.obj",
                                   "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
                                   "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 5 0\nvt 6 0\nvt 6 1\nvt 5 1\n"
                                   "f 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n");
  const WeldedSurface joined = welded(file.mesh, 1e-6, "a.obj");
  const FileCorners corners = corners_in(file.mesh, joined);
  const auto seams = file_seams(joined.mesh, corners, file);
  ASSERT_EQ(seams.size(), 1u);
  for (const std::int32_t v : seams.front()) EXPECT_NEAR(joined.mesh.points(v, 0), 1, 1e-12);
  RemeshOptions options;
  options.edge_length = 0.15;
  options.lines = seams;
  const RemeshedSurface fine = remeshed(joined.mesh, options, "a.obj");
  const FileCorners fine_corners = corners_in(corners, fine);
  ASSERT_EQ(Eigen::Index(fine_corners.size()), fine.mesh.triangles.rows());
  for (Eigen::Index t = 0; t < fine.mesh.triangles.rows(); ++t) {
    double middle = 0;
    for (int k = 0; k < 3; ++k) middle += fine.mesh.points(fine.mesh.triangles(t, k), 0) / 3;
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = fine.mesh.points.row(fine.mesh.triangles(t, k));
      const Eigen::Vector2d at = texture_place(fine_corners[std::size_t(t)][std::size_t(k)], file);
      EXPECT_NEAR(at.x(), p.x() + (middle > 1 ? 4 : 0), 1e-6);
      EXPECT_NEAR(at.y(), p.y(), 1e-6);
    }
  }
}

}  // namespace surface_parts_test
}  // namespace supple
