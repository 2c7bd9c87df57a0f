// Tests that cloth from a file keeps what the file says: colours and textures.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "film/pictures/drawn_cloth.h"
#include "scene/building/assemble.h"
#include "scene/building/drawn_body.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"
#include "support/colored_files.h"

namespace supple {
namespace cloth_from_file_test {

constexpr int cells = 8;  // of the sheet, along each side

// Says how a sheet of 1 m by 1 m is written. Its two halves meet at x = 0.5.
struct SheetFile {
  double gap = 0;                                                               // between the halves [m]
  std::array<double, 2> left = {0, 0.25}, right = {1, -0.25};                   // u = first + second x, on each half
  std::string left_name = "g left", right_name = "o right side\nusemtl print";  // lines before their faces
  bool places = true, right_places = true;
};

// Returns an OBJ file of a sheet in the plane z = 0, whose v is y / 4.
std::string sheet_text(const SheetFile& sheet) {
  std::string text = "mtllib sheet.mtl\n", faces[2];
  int vertices = 0;
  for (int half = 0; half < 2; ++half) {
    const auto& [first, slope] = half == 0 ? sheet.left : sheet.right;
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells / 2; ++i) {
        const double x = 0.5 * half + double(i) / cells, y = double(j) / cells;
        text += fmt::format("v {} {} 0\nvt {} {}\n", x + half * sheet.gap, y, first + slope * x, y / 4);
      }
    }
    const bool placed = sheet.places && (half == 0 || sheet.right_places);
    const auto corner = [&](int i, int j) {
      const int number = vertices + j * (cells / 2 + 1) + i + 1;
      return placed ? fmt::format(" {0}/{0}", number) : fmt::format(" {}", number);
    };
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells / 2; ++i) {
        faces[half] += "f" + corner(i, j) + corner(i + 1, j) + corner(i + 1, j + 1) + "\n";
        faces[half] += "f" + corner(i, j) + corner(i + 1, j + 1) + corner(i, j + 1) + "\n";
      }
    }
    vertices += (cells + 1) * (cells / 2 + 1);
  }
  return text + sheet.left_name + "\nusemtl print\n" + faces[0] + sheet.right_name + "\n" + faces[1];
}

class ClothFromFile : public ::testing::Test {
 protected:
  ClothFromFile() {
    test::write_text(folder_.path / "sheet.mtl", "newmtl print\nKd 1 1 1\nmap_Kd print.png\n");
    write_png(folder_.path / "print.png", 32, 32, test::squares_picture(32, 4));
    write({});
  }
  void write(const SheetFile& sheet) const { test::write_text(folder_.path / "sheet.obj", sheet_text(sheet)); }

  SceneDef scene_with(const std::string& cloth, const std::string& keys = "") const {
    test::write_text(folder_.path / "s.toml", fmt::format("[[body]]\nname = \"sheet\"\nmaterial = \"cotton\"\n"
                                                          "cloth = {{ {} }}\n{}",
                                                          cloth, keys));
    return load_scene(folder_.path / "s.toml", test::assets, {});
  }
  Body body_of(const std::string& cloth, const std::string& keys = "") const {
    return assemble(scene_with(cloth, keys)).front();
  }
  DrawnBody drawn_of(const std::string& cloth, const std::string& keys = "") const {
    return drawn_bodies({body_of(cloth, keys)}).front();
  }
  test::TemporaryFolder folder_;
};

bool has(const std::vector<std::string>& notes, const std::string& part) {
  return std::ranges::any_of(notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

// Checks that each drawn triangle lies on one side of the seam, and has the texture's places of its corners there.
void expect_texture_of_sheet(const DrawnBody& drawn, const Positions& rest) {
  const Skin& skin = drawn.skin;
  ASSERT_EQ(skin.color.size(), drawn.vertex_of.size());
  ASSERT_EQ(skin.flat.size(), drawn.vertex_of.size());
  const double low = rest.col(0).minCoeff(), bottom = rest.col(1).minCoeff();
  for (Eigen::Index t = 0; t < skin.rest.triangles.rows(); ++t) {
    double x[3], middle = 0;
    for (int k = 0; k < 3; ++k) {
      x[k] = rest(drawn.vertex_of[std::size_t(skin.rest.triangles(t, k))], 0) - low;
      middle += x[k] / 3;
    }
    for (int k = 0; k < 3; ++k) {
      const auto vertex = std::size_t(skin.rest.triangles(t, k));
      EXPECT_TRUE(middle < 0.5 ? x[k] < 0.5 + 1e-6 : x[k] > 0.5 - 1e-6) << x[k];
      EXPECT_EQ(skin.color[vertex].texture, 0);
      EXPECT_NEAR(skin.color[vertex].u, middle < 0.5 ? 0.25 * x[k] : 1 - 0.25 * x[k], 1e-5);
      EXPECT_NEAR(skin.color[vertex].v, (rest(drawn.vertex_of[vertex], 1) - bottom) / 4, 1e-5);
    }
  }
}

TEST_F(ClothFromFile, ATextureIsOnEachSideOfItsSeamAsTheFileHasIt) {
  const Body body = body_of("surface = \"sheet.obj\"");
  EXPECT_EQ(body.description.mesh.rest.rows(), (cells + 1) * (cells + 1));  // the seam is one line of vertices
  const DrawnBody drawn = drawn_bodies({body}).front();
  EXPECT_EQ(std::ssize(drawn.vertex_of), (cells + 1) * (cells + 2));  // which is drawn as two
  ASSERT_TRUE(drawn.textures);
  expect_texture_of_sheet(drawn, body.description.mesh.rest);
}

TEST_F(ClothFromFile, NewTrianglesHaveTheTextureToo) {
  const Body body = body_of("surface = \"sheet.obj\", edge = 0.05");
  EXPECT_GT(body.description.mesh.rest.rows(), 300);
  expect_texture_of_sheet(drawn_bodies({body}).front(), body.description.mesh.rest);
}

TEST_F(ClothFromFile, ColoursStayWhenItIsDrawnMoreFinely) {
  const Body body = body_of("surface = \"sheet.obj\"");
  DrawnBody drawn = drawn_bodies({body}).front();
  const std::size_t before = drawn.skin.color.size();
  smooth_for_pixels(drawn, body.description.mesh.rest, 0.002);
  EXPECT_GT(drawn.skin.color.size(), 4 * before);
  EXPECT_EQ(Eigen::Index(drawn.skin.color.size()), drawn.skin.rest.points.rows());
  for (std::size_t v = 0; v < drawn.skin.color.size(); ++v) {
    const double x = drawn.skin.rest.points(Eigen::Index(v), 0) + 0.5, u = drawn.skin.color[v].u;
    EXPECT_LT(std::min(std::abs(u - 0.25 * x), std::abs(u - 1 + 0.25 * x)), 2e-3) << x << " " << u;
  }
}

TEST_F(ClothFromFile, ItsColoursAreTheFilesUnlessTheSceneSaysOtherwise) {
  EXPECT_FALSE(drawn_of("surface = \"sheet.obj\"").skin.color.empty());
  EXPECT_TRUE(drawn_of("surface = \"sheet.obj\"", "color = [1, 0, 0]\n").skin.color.empty());
  EXPECT_TRUE(drawn_of("surface = \"sheet.obj\"", "colors = \"body\"\n").skin.color.empty());
  EXPECT_FALSE(drawn_of("surface = \"sheet.obj\"", "color = [1, 0, 0]\ncolors = \"file\"\n").skin.color.empty());
  // What is drawn is among its sources, and a print lies over the file's colours only where one is asked for.
  EXPECT_EQ(body_of("surface = \"sheet.obj\"").files.size(), 2u);
  EXPECT_EQ(body_of("surface = \"sheet.obj\"", "colors = \"body\"\n").files.size(), 1u);
  EXPECT_TRUE(drawn_of("surface = \"sheet.obj\"").skin.square.empty());
  EXPECT_FALSE(drawn_of("surface = \"sheet.obj\"", "pattern = \"checks\"\n").skin.square.empty());
  EXPECT_FALSE(drawn_of("surface = \"sheet.obj\"", "colors = \"body\"\n").skin.square.empty());
}

TEST_F(ClothFromFile, TheMeshDoesNotDependOnWhoseColoursAreDrawn) {
  const Body file = body_of("surface = \"sheet.obj\", edge = 0.07"),
             own = body_of("surface = \"sheet.obj\", edge = 0.07", "colors = \"body\"\n");
  EXPECT_EQ(file.description.mesh.rest, own.description.mesh.rest);
}

TEST_F(ClothFromFile, WhatIsMissingIsNamed) {
  std::filesystem::remove(folder_.path / "print.png");
  EXPECT_TRUE(has(body_of("surface = \"sheet.obj\"").notes, "texture 'print.png' is missing"));
  std::filesystem::remove(folder_.path / "sheet.mtl");
  EXPECT_TRUE(has(body_of("surface = \"sheet.obj\"", "colors = \"file\"\n").notes, "the file has no colours"));
}

TEST_F(ClothFromFile, ColoursOfVerticesStayAtTheirPlaces) {
  const auto red = [](const Vec3& p) { return std::array{int(255 * std::clamp(p.y() + 0.5, 0.0, 1.0)), 0, 0}; };
  test::write_text(folder_.path / "ball.ply", test::ply_text(test::sphere_surface(0.5, 32, 16), red));
  const Body body = body_of("surface = \"ball.ply\", edge = 0.06");
  const DrawnBody drawn = drawn_bodies({body}).front();
  double furthest = 0;
  for (std::size_t v = 0; v < drawn.skin.color.size(); ++v) {
    const double byte = red(body.unplaced.row(drawn.vertex_of[v]).transpose())[0] / 255.0;
    const double linear = byte <= 0.04045 ? byte / 12.92 : std::pow((byte + 0.055) / 1.055, 2.4);
    furthest = std::max(furthest, std::abs(drawn.skin.color[v].red - linear));
  }
  EXPECT_LT(furthest, 0.03);  // colours are linear within the triangles of the file
  EXPECT_FALSE(drawn.skin.color.empty());
}

TEST_F(ClothFromFile, ATextureInWhichEachTriangleLiesApartHasNoLinesThatStay) {
  std::string vertices, faces;
  int corners = 0;
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const std::array<std::array<int, 2>, 3> halves[2] = {{{{i, j}, {i + 1, j}, {i + 1, j + 1}}},
                                                           {{{i, j}, {i + 1, j + 1}, {i, j + 1}}}};
      for (const auto& half : halves) {
        const double apart = 0.3 * corners;
        faces += "f";
        for (const auto& [x, y] : half) {
          vertices +=
              fmt::format("v {0} {1} 0\nvt {2} {1}\n", x / double(cells), y / double(cells), x / double(cells) + apart);
          faces += fmt::format(" {0}/{0}", ++corners);
        }
        faces += "\n";
      }
    }
  }
  test::write_text(folder_.path / "sheet.obj", "mtllib sheet.mtl\n" + vertices + "usemtl print\n" + faces);
  EXPECT_TRUE(
      has(body_of("surface = \"sheet.obj\", edge = 0.06").notes, "along 176 edges between 128 triangles: too many"));
}

}  // namespace cloth_from_file_test
}  // namespace supple
