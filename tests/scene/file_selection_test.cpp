// Tests that handles take the vertices of which a surface's file says something: a name, a colour, or a place in the
// texture where a painted mask is bright.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/skins/surface_colors.h"
#include "support/sheet_from_file.h"
#include "support/surfaces.h"

namespace supple {
namespace file_selection_test {

using test::cells;
using test::expect_part;

class FileSelection : public test::SheetFromFile {};

TEST_F(FileSelection, HandlesTakeGroupsObjectsAndMaterialsByTheirNames) {
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

TEST_F(FileSelection, ANameThatIsNotThereIsRefusedWithThoseThatAre) {
  const std::string message = refusal_to_hold("group = \"lefd\"");
  expect_part(message, "its file names nothing 'lefd'; did you mean 'left'?; it names 'left', 'print', 'right side'");
  test::write_text(folder_.path / "sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_part(refusal_to_hold("group = \"left\""), "not made of a file that names groups");
  expect_part(refusal_to_hold("color = \"#ffffff\""), "not made of a file that has colours");
}

TEST_F(FileSelection, HandlesTakeColoursOfTexturesAndNameTheNearestWhereThereIsNone) {
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

TEST_F(FileSelection, AMaskTakesWhatHasABrightPlaceInTheTexture) {
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

TEST_F(FileSelection, AMaskTakesPixelsThatAreBrighterThanAbove) {
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

TEST_F(FileSelection, MasksThatCannotBeReadOrLieOnNothingAreRefused) {
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

TEST_F(FileSelection, SolidsAreHeldByMasksNearTheirSurface) {
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

TEST_F(FileSelection, SolidsAreHeldByNamesAndColoursNearTheirSurface) {
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

}  // namespace file_selection_test
}  // namespace supple
