// Tests that cloth from a file keeps what the file says: colours and textures, the flat pieces that its texture
// coordinates are, and borders that are sewn.
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
#include "support/sheet_from_file.h"

namespace supple {
namespace cloth_from_file_test {

using test::cells;
using test::expect_part;
using test::has;

class ClothFromFile : public test::SheetFromFile {};

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
