// Tests that cloth from a file keeps what the file says: colours and textures, names of parts, the flat pieces that its
// texture coordinates are, and borders that are sewn.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "film/pictures/drawn_cloth.h"
#include "geometry/skins/surface_colors.h"
#include "scene/building/assemble.h"
#include "scene/building/cloth_cut.h"
#include "scene/building/drawn_body.h"
#include "scene/building/warnings.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"
#include "support/colored_files.h"
#include "support/scene_text.h"

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
  std::string refusal_of(const std::string& cloth, const std::string& keys = "") const {
    try {
      body_of(cloth, keys);
      return "nothing";
    } catch (const InputError& error) {
      EXPECT_GT(error.problems().front().place.line, 0);
      return error.problems().front().message;
    }
  }
  std::vector<Vec3> held(const std::string& select, const std::string& cloth = "surface = \"sheet.obj\"") const {
    const Body body = body_of(cloth, "[[body.handles]]\nname = \"pins\"\nselect = { " + select + " }\n");
    std::vector<Vec3> places;
    for (const std::int32_t v : body.description.handles.front().vertices)
      places.push_back(body.unplaced.row(v).transpose());
    return places;
  }
  std::string refusal_to_hold(const std::string& select) const {
    return refusal_of("surface = \"sheet.obj\"", "[[body.handles]]\nname = \"pins\"\nselect = { " + select + " }\n");
  }
  test::TemporaryFolder folder_;
};

bool has(const std::vector<std::string>& notes, const std::string& part) {
  return std::ranges::any_of(notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

void expect_part(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "found: " << text;
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

TEST_F(ClothFromFile, HandlesTakeGroupsObjectsAndMaterialsByTheirNames) {
  const std::vector<Vec3> left = held("group = \"left\""), right = held("group = \"right side\"");
  EXPECT_EQ(left.size(), std::size_t((cells + 1) * (cells / 2 + 1)));
  for (const Vec3& p : left) EXPECT_LE(p.x(), 0.5);
  EXPECT_EQ(right.size(), left.size());
  for (const Vec3& p : right) EXPECT_GE(p.x(), 0.5);
  expect_part(refusal_to_hold("group = \"print\""), "every vertex of body 'sheet' is held");  // its only material
  const std::vector<Vec3> rim = held("group = \"left\", border = true");
  EXPECT_EQ(rim.size(), std::size_t(2 * cells + 1));
  // The border between two groups stays a line where the triangles are new.
  const std::vector<Vec3> fine = held("group = \"left\"", "surface = \"sheet.obj\", edge = 0.05");
  EXPECT_GT(fine.size(), 150u);
  EXPECT_NEAR(std::ranges::max(fine, {}, [](const Vec3& p) { return p.x(); }).x(), 0.5, 1e-9);
}

TEST_F(ClothFromFile, ANameThatIsNotThereIsRefusedWithThoseThatAre) {
  const std::string message = refusal_to_hold("group = \"lefd\"");
  expect_part(message, "its file names nothing 'lefd'; did you mean 'left'?; it names 'left', 'print', 'right side'");
  test::write_text(folder_.path / "sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_part(refusal_to_hold("group = \"left\""), "not made of a file that names groups");
  expect_part(refusal_to_hold("color = \"#ffffff\""), "not made of a file that has colours");
}

TEST_F(ClothFromFile, HandlesTakeColoursOfTexturesAndNameTheNearestWhereThereIsNone) {
  std::vector<std::uint8_t> rgb(3 * 8 * 8, 255);
  for (std::size_t i = 0; i < rgb.size(); i += 3)
    if (i / 3 % 8 < 1) rgb[i + 1] = rgb[i + 2] = 20;  // the left eighth of the texture is red
  write_png(folder_.path / "print.png", 8, 8, rgb);
  const std::vector<Vec3> red = held("color = \"#ff1414\", tolerance = 0.01");
  EXPECT_EQ(red.size(), std::size_t((cells + 1) * cells / 2));  // u = x / 4 below 1/8, and where 1 - x / 4 is not 1
  for (const Vec3& p : red) EXPECT_LT(p.x(), 0.5);
  expect_part(refusal_to_hold("color = \"#ff3c14\", tolerance = 0.1"),
              "the nearest colour at its vertices is \"#ff1414\", which tolerance = 0.16 takes");
  EXPECT_EQ(held("color = \"#ff3c14\", tolerance = 0.16").size(), red.size());
}

// Returns a grey picture of 16 x 8 pixels that has one value in the given columns and rows, counted from the lower left
// corner, and is black elsewhere.
std::vector<std::uint8_t> picture_with(std::array<int, 2> columns, std::array<int, 2> rows, std::uint8_t value) {
  std::vector<std::uint8_t> rgb(3 * 16 * 8, 0);
  for (int y = rows[0]; y < rows[1]; ++y)
    for (int x = columns[0]; x < columns[1]; ++x)
      for (int c = 0; c < 3; ++c) rgb[std::size_t(3 * ((7 - y) * 16 + x) + c)] = value;
  return rgb;
}

TEST_F(ClothFromFile, AMaskTakesWhatHasABrightPlaceInTheTexture) {
  // The right half has u from 7/8 at the seam to 6/8, and v = y / 4. At the seam the left half has u = 1/8, where the
  // picture is black.
  write_png(folder_.path / "pins.png", 16, 8, picture_with({13, 15}, {0, 1}, 255));
  const auto expect_place = [](const Vec3& p) {
    EXPECT_TRUE(p.x() > 0.5 - 1e-6 && p.x() < 0.75 + 1e-6 && p.y() < 0.5) << p.transpose();
  };
  const std::vector<Vec3> pins = held("mask = \"pins.png\"");
  EXPECT_EQ(pins.size(), 3u * cells / 2);
  EXPECT_EQ(std::ranges::count_if(pins, [](const Vec3& p) { return p.x() < 0.51; }), cells / 2);
  for (const Vec3& p : pins) expect_place(p);
  EXPECT_EQ(held("mask = \"pins.png\", border = true").size(), 3u);
  // New triangles have their texture coordinates between those of the file.
  const std::vector<Vec3> fine = held("mask = \"pins.png\"", "surface = \"sheet.obj\", edge = 0.05");
  EXPECT_GT(fine.size(), 30u);
  for (const Vec3& p : fine) expect_place(p);
}

TEST_F(ClothFromFile, AMaskTakesPixelsThatAreBrighterThanAbove) {
  write_png(folder_.path / "pins.png", 16, 8, picture_with({0, 1}, {0, 8}, 128));
  EXPECT_EQ(held("mask = \"pins.png\"").size(), std::size_t(2 * (cells + 1)));  // u = 0 and 1/32
  EXPECT_EQ(held("mask = \"pins.png\", above = 0.501").size(), std::size_t(2 * (cells + 1)));
  expect_part(refusal_to_hold("mask = \"pins.png\", above = 0.51"),
              "selects no vertex: at its texture coordinates 'pins.png' is 0.50 bright at most; above = 0.51 asks for");
  const Body body =
      body_of("surface = \"sheet.obj\"", "[[body.handles]]\nname = \"pins\"\nselect = { mask = \"pins.png\" }\n");
  EXPECT_EQ(body.files.back().path.filename(), "pins.png");  // what a film was made of names the picture
}

TEST(Masks, BothEdgesBelongToThePictureWhichRepeatsBeyond) {
  Texture picture;  // its upper right pixel is red, the others are black
  picture.width = picture.height = 2;
  picture.rgb = {0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0, 0};
  constexpr double red = 0.2126;
  EXPECT_NEAR(brightness_at(picture, {1, 1}), red, 1e-9);
  EXPECT_NEAR(brightness_at(picture, {0.5, 0.5}), red, 1e-9);
  EXPECT_NEAR(brightness_at(picture, {-0.25, 1.75}), red, 1e-9);
  for (const Eigen::Vector2d& dark : {Eigen::Vector2d(0, 1), Eigen::Vector2d(1, 0), Eigen::Vector2d(1.25, 0.75)})
    EXPECT_EQ(brightness_at(picture, dark), 0);
}

TEST_F(ClothFromFile, MasksThatCannotBeReadOrLieOnNothingAreRefused) {
  const auto refused = [&](const std::string& select) { return refusal_to_hold("mask = \"pins.png\"" + select); };
  expect_part(refused(""), "no such file");
  test::write_text(folder_.path / "pins.png", "no picture");
  expect_part(refused(""), "mask = 'pins.png': cannot be read: is neither PNG, JPEG, TGA nor BMP");
  write_png(folder_.path / "pins.png", 16, 8, picture_with({0, 16}, {0, 8}, 255));
  std::string bytes = test::read_file(folder_.path / "pins.png");
  test::write_text(folder_.path / "pins.png", bytes.substr(0, bytes.size() / 2));
  expect_part(refused(""), "cannot be read: is no PNG that can be read");
  test::write_text(folder_.path / "pins.png", bytes);
  expect_part(refused(", above = 2"), "above = 2: must be");
  expect_part(refused(", color = \"#ff0000\""), "a selection is one of");
  expect_part(refusal_to_hold("border = true, above = 0.5"), "above: of a mask; there is none here");
  write({.places = false});
  expect_part(refused(""), "not made of a surface's file that has texture coordinates");
}

TEST_F(ClothFromFile, SolidsAreHeldByMasksNearTheirSurface) {
  const TriMesh ball = test::sphere_surface(0.5, 32, 16);
  std::string places, faces;
  for (Eigen::Index v = 0; v < ball.points.rows(); ++v) places += fmt::format("vt 0.5 {}\n", ball.points(v, 1) + 0.5);
  for (const auto& t : ball.triangles.rowwise())
    faces += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", t.x() + 1, t.y() + 1, t.z() + 1);
  const std::string text = test::obj_text(ball), head = text.substr(0, text.find("f "));
  test::write_text(folder_.path / "ball.obj", head + places + faces);
  write_png(folder_.path / "pins.png", 16, 8, picture_with({0, 16}, {6, 8}, 255));
  const auto held_of = [&] {
    test::write_text(folder_.path / "b.toml",
                     "[[body]]\nmaterial = \"jelly\"\nvertices = 2000\nsurface = \"ball.obj\"\n[[body.handles]]\n"
                     "name = \"top\"\nselect = { mask = \"pins.png\" }\n");
    return assemble(load_scene(folder_.path / "b.toml", test::assets, {})).front();
  };
  const Body body = held_of();
  EXPECT_GT(body.description.handles.front().vertices.size(), 40u);
  for (const std::int32_t v : body.description.handles.front().vertices) {
    EXPECT_GT(body.unplaced(v, 1), 0.2);  // the picture is bright above 0.25, where an element is 0.1 large
    EXPECT_GT(body.unplaced.row(v).norm(), 0.35);
  }
  test::write_text(folder_.path / "ball.obj", text);
  EXPECT_THROW(held_of(), InputError);
}

TEST_F(ClothFromFile, SolidsAreHeldByNamesAndColoursNearTheirSurface) {
  std::string text = test::obj_text(test::sphere_surface(0.5, 32, 16));
  std::string upper = "g top\n", lower = "g rest\n", head;
  const TriMesh ball = test::sphere_surface(0.5, 32, 16);
  for (Eigen::Index t = 0; t < ball.triangles.rows(); ++t) {
    double y = 0;
    for (int k = 0; k < 3; ++k) y += ball.points(ball.triangles(t, k), 1) / 3;
    (y > 0.3 ? upper : lower) +=
        fmt::format("f {} {} {}\n", ball.triangles(t, 0) + 1, ball.triangles(t, 1) + 1, ball.triangles(t, 2) + 1);
  }
  head = text.substr(0, text.find("f "));
  test::write_text(folder_.path / "ball.obj", head + upper + lower);
  test::write_text(folder_.path / "ball.ply", test::ply_text(ball, [](const Vec3& p) {
                     return p.y() > 0.3 ? std::array{255, 0, 0} : std::array{0, 0, 255};
                   }));
  for (const char* by :
       {"surface = \"ball.obj\"\n[[body.handles]]\nname = \"top\"\nselect = { group = \"top\" }\n",
        "surface = \"ball.ply\"\n[[body.handles]]\nname = \"top\"\nselect = { color = \"#ff0000\" }\n"}) {
    test::write_text(folder_.path / "b.toml", fmt::format("[[body]]\nmaterial = \"jelly\"\nvertices = 2000\n{}", by));
    const Body body = assemble(load_scene(folder_.path / "b.toml", test::assets, {})).front();
    const std::vector<std::int32_t>& vertices = body.description.handles.front().vertices;
    EXPECT_GT(vertices.size(), 40u);
    EXPECT_LT(vertices.size(), 400u);
    for (const std::int32_t v : vertices) {
      EXPECT_GT(body.unplaced(v, 1), 0.2);
      EXPECT_GT(body.unplaced.row(v).norm(), 0.35);
    }
  }
}

TEST_F(ClothFromFile, ACutIsAtRestAsItLiesInTheTexture) {
  // A unit of the texture is 8 m, so that the flat sheet has twice the lengths of the placed one.
  const Body body = body_of("surface = \"sheet.obj\", cut = \"texture\", cut_scale = 8");
  double area = 0, mass = 0;
  const Positions& rest = body.description.mesh.rest;
  for (const FlatTriangle& triangle : body.description.cloth) {
    area += triangle.area();
    for (int k = 0; k < 2; ++k) {
      const Vec3 edge = rest.row(triangle.corner[std::size_t(k) + 1]) - rest.row(triangle.corner[0]);
      EXPECT_NEAR(triangle.edges[k], 2 * edge.y(), 1e-5);       // the warp is along v
      EXPECT_NEAR(triangle.edges[2 + k], -2 * edge.x(), 1e-5);  // also on the half that is mirrored in the texture
    }
  }
  for (const double one : body.description.point_mass) mass += one;
  EXPECT_NEAR(area, 4, 1e-5);
  EXPECT_NEAR(mass, 4 * 0.124, 1e-5);
  EXPECT_TRUE(has(body.notes, "64 of its 128 triangles are mirrored"));
  EXPECT_TRUE(has(body.notes, "stretched against this cut by 0.50 at least, 0.50 in the median and 0.50 at most"));
}

TEST_F(ClothFromFile, WithoutAScaleACutHasTheAreaOfThePlacedSurfaceAndGrainTurnsInItsPlane) {
  const Body body = body_of("surface = \"sheet.obj\", cut = \"texture\", grain = [1, 0, 0]", "size = 3\n");
  EXPECT_NEAR(cut_scale(body), 12, 1e-5);
  const Positions& rest = body.description.mesh.rest;
  for (const FlatTriangle& triangle : body.description.cloth) {
    for (int k = 0; k < 2; ++k) {
      const Vec3 edge = rest.row(triangle.corner[std::size_t(k) + 1]) - rest.row(triangle.corner[0]);
      EXPECT_NEAR(std::abs(triangle.edges[k]), std::abs(edge.x()), 1e-4);
    }
  }
  EXPECT_FALSE(std::ranges::any_of(warnings(SceneDef(), {body}),
                                   [](const Warning& one) { return one.kind == WarningKind::cut; }));
}

TEST_F(ClothFromFile, NewTrianglesOfACutLieInItsPieces) {
  const Body body = body_of("surface = \"sheet.obj\", edge = 0.05, cut = \"texture\", cut_scale = 4");
  const CutStretch stretch = cut_stretch(body);
  EXPECT_NEAR(stretch.least, 1, 1e-4);
  EXPECT_NEAR(stretch.largest, 1, 1e-4);
  double area = 0;
  for (const FlatTriangle& triangle : body.description.cloth) area += triangle.area();
  EXPECT_NEAR(area, 1, 1e-3);
}

TEST_F(ClothFromFile, AWarningTellsOfACutThatDoesNotFit) {
  const auto cut_warnings = [&](const std::string& scale) {
    const SceneDef scene = scene_with("surface = \"sheet.obj\", cut = \"texture\", cut_scale = " + scale);
    std::vector<std::string> found;
    for (const Warning& one : warnings(scene, assemble(scene)))
      if (one.kind == WarningKind::cut) found.push_back(one.problem.message);
    return found;
  };
  EXPECT_TRUE(cut_warnings("4").empty());
  EXPECT_TRUE(cut_warnings("3").empty());
  ASSERT_EQ(cut_warnings("2.5").size(), 1u);
  expect_part(cut_warnings("2.5").front(), "100 % of its triangles are stretched beyond 1.5");
  expect_part(cut_warnings("2.5").front(), "cut_scale = 4 would give the cut the area of the surface");
}

TEST_F(ClothFromFile, ATextureThatIsNoCutIsRefused) {
  write({.places = false});
  expect_part(refusal_of("surface = \"sheet.obj\", cut = \"texture\""), "all triangles have no texture coordinates");
  write({.right_places = false});
  expect_part(refusal_of("surface = \"sheet.obj\", cut = \"texture\""),
              "64 of 128 triangles have no texture coordinates, the first at (0.583, 0.0417, 0)");
  write({.right = {0.3, 0}});
  expect_part(refusal_of("surface = \"sheet.obj\", cut = \"texture\""),
              "64 of 128 triangles have no area in the texture, the first at (0.583, 0.0417, 0)");
}

TEST_F(ClothFromFile, ATextureInWhichEachTriangleLiesApartKeepsNewTrianglesFromACut) {
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
  expect_part(refusal_of("surface = \"sheet.obj\", edge = 0.06, cut = \"texture\""),
              "without edge the triangles are the file's");
  EXPECT_NEAR(cut_stretch(body_of("surface = \"sheet.obj\", cut = \"texture\"")).largest, 1, 1e-4);
}

TEST_F(ClothFromFile, BordersThatAreNearAreSewn) {
  write({.gap = 0.002});
  const Body open = body_of("surface = \"sheet.obj\""), sewn = body_of("surface = \"sheet.obj\", sew = 0.003");
  EXPECT_EQ(open.description.mesh.rest.rows() - sewn.description.mesh.rest.rows(), cells + 1);
  EXPECT_EQ(sewn.description.cloth.size(), open.description.cloth.size());
  EXPECT_TRUE(has(sewn.notes,
                  "9 border vertices were sewn to others, which were up to 0.002 m apart; 32 border "
                  "vertices remain"));
  EXPECT_TRUE(has(body_of("surface = \"sheet.obj\", sew = 0.001").notes, "sew = 0.001 m joins nothing"));
  // The distance is that of the finished body, and what is sewn has new triangles as one sheet.
  const Body large = body_of("surface = \"sheet.obj\", sew = 0.03, edge = 0.5", "size = 10\n");
  EXPECT_TRUE(has(large.notes, "9 border vertices were sewn"));
}

TEST_F(ClothFromFile, MistakesAreNamed) {
  const auto problem = [](const std::string& cloth, const std::string& keys = "") {
    const std::vector<std::string> found =
        test::problems_of("[[body]]\nmaterial = \"cotton\"\ncloth = { " + cloth + " }\n" + keys);
    return found.empty() ? "nothing" : found.front();
  };
  const std::string grid = "extent = [1, 1], cells = [2, 2]", ball = "surface = \"surfaces/ball.obj\"";
  for (const char* key : {"cut = \"texture\"", "cut_scale = 2", "sew = 0.1"})
    expect_part(problem(grid + ", " + key), "of a cloth with a surface; there is none here");
  expect_part(problem(ball + ", cut_scale = 2"), "cut_scale: of cut = \"texture\"");
  expect_part(problem(ball + ", cut = \"texture\", grain = [0, 0, 1]"), "it lies in the texture, as [u, v, 0]");
  expect_part(problem(ball + ", cut = \"pattern\""), "surface or texture");
  const std::string handle = "[[body.handles]]\nname = \"pins\"\nselect = { ";
  expect_part(problem(ball, handle + "border = true, tolerance = 0.2 }\n"), "tolerance: of a color");
  expect_part(problem(ball, handle + "group = \"a\", color = \"#ff0000\" }\n"), "a selection is one of");
}

}  // namespace cloth_from_file_test
}  // namespace supple
