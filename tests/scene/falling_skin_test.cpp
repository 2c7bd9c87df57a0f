// Tests that the skins of soft bodies that fall hard stay whole: no edge of a skin is stretched much more than the
// elements below it.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "geometry/skins/skin_stretch.h"
#include "output/files/obj_file.h"
#include "scene/building/drawn_body.h"
#include "support/film.h"
#include "support/surfaces.h"

namespace supple {
namespace falling_skin_test {

struct Fall {
  double ratio = 0;    // the largest stretch of a skin's edge over that of the elements, of all frames
  double stretch = 0;  // the largest of the elements
  double outside = 0;  // share of the skin's vertices outside all elements
  int skin_vertices = 0;
};

// Lets a body of soft jelly hit the ground at 3 m/s. body: the keys that say what it is, and how it is turned.
Fall fall(const std::filesystem::path& folder, const std::string& body, int frames) {
  std::ofstream(folder / "s.toml") << "[[body]]\nname = \"it\"\nsize = 0.4\nposition = [0, 0.35, 0]\n"
                                      "velocity = [0, -3, 0]\nmaterial = \"jelly\"\n"
                                   << body << "\n[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\n";
  const test::Film film(folder / "s.toml", {});
  const DrawnBody drawn = drawn_bodies(film.bodies).front();
  const TetMesh& mesh = film.bodies[0].description.mesh;
  const double shortest = 1e-4 * bounds_of(mesh.rest).diagonal();
  Fall result;
  result.outside = outside_share(drawn.embedding).share;
  result.skin_vertices = int(drawn.skin.rest.points.rows());
  film.play(2, frames, [&](std::size_t, int, const State&, const StepInputs&, const State& after) {
    const Positions now = in_input_order(film.models[0], after.x);
    const double elements = largest_element_stretch(mesh, now);
    const double skin = most_stretched_edge(drawn.skin.rest, embedded_points(drawn.embedding, now), shortest).factor;
    result.ratio = std::max(result.ratio, skin / elements);
    result.stretch = std::max(result.stretch, elements);
  });
  return result;
}

// A skin of which much lies outside comes through an impact that stretches its elements by a fourth and more.
void expect_whole(const Fall& fall) {
  EXPECT_LE(fall.ratio, 1.5);
  EXPECT_GT(fall.stretch, 1.25);
  EXPECT_GT(fall.outside, 0.2);
}

TEST(FallingSkin, OfACoarseBunnyStaysWholeFromItsEars) {
  const test::TemporaryFolder folder;
  expect_whole(fall(folder.path, "shape = \"shapes/bunny.toml\"\nvertices = 1500\nturn_deg = [150, 20, 0]", 30));
}

TEST(FallingSkin, OfTwoLegsThatAlmostTouchStaysWhole) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "legs.toml") << R"(
[[part]]
ellipsoid = { radii = [0.35, 0.4, 0.25] }
position = [0, 1.2, 0]
[[part]]
round_cone = { ends = [[0.15, 1.0, 0], [0.14, 0.1, 0]], radius = 0.16, end_radius = 0.11 }
mirror = true
blend = 0.05
[[part]]
ellipsoid = { radii = [0.125, 0.09, 0.28] }
position = [0.14, 0.09, 0.12]
mirror = true
blend = 0.03
)";
  for (const char* vertices : {"1000", "4000"})
    expect_whole(
        fall(folder.path, fmt::format("shape = \"legs.toml\"\nvertices = {}\nturn_deg = [0, 0, 20]", vertices), 20));
}

// Makes a gear of flat faces, each a fan of long triangles around its centre, as CAD programs write them.
TriMesh gear_surface(int teeth) {
  const int rim = 4 * teeth;
  TriMesh mesh;
  mesh.points.resize(2 * rim + 2, 3);
  mesh.triangles.resize(4 * rim, 3);
  constexpr double place[] = {0, 0.3, 0.55, 0.85}, radius[] = {1, 1.25, 1.25, 1};
  for (int i = 0; i < rim; ++i) {
    const double a = 2 * std::numbers::pi * (i / 4 + place[i % 4]) / teeth, r = radius[i % 4];
    mesh.points.row(i) << r * std::cos(a), -0.125, r * std::sin(a);
    mesh.points.row(rim + i) << r * std::cos(a), 0.125, r * std::sin(a);
    const int j = (i + 1) % rim;
    mesh.triangles.row(4 * i) << i, j, 2 * rim;
    mesh.triangles.row(4 * i + 1) << rim + j, rim + i, 2 * rim + 1;
    mesh.triangles.row(4 * i + 2) << i, rim + i, rim + j;
    mesh.triangles.row(4 * i + 3) << i, rim + j, j;
  }
  mesh.points.bottomRows(2) << 0, -0.125, 0, 0, 0.125, 0;
  return mesh;
}

TEST(FallingSkin, OfAGearThatFallsFlatAndOfACubeOfTwelveTrianglesStaysWholeAndBends) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "gear.obj") << test::obj_text(gear_surface(16));
  std::ofstream(folder.path / "cube.obj") << test::obj_text(test::box_surface(Vec3(0.5, 0.5, 0.5)));
  const Fall gear = fall(folder.path, "surface = \"gear.obj\"\nvertices = 2000\nturn_deg = [3, 0, 0]", 20);
  const Fall cube = fall(folder.path, "surface = \"cube.obj\"\nvertices = 1000\nturn_deg = [3, 0, 0]", 20);
  for (const Fall& one : {gear, cube}) {
    EXPECT_LE(one.ratio, 1.5);
    EXPECT_GT(one.stretch, 1.1);
  }
  EXPECT_GT(gear.skin_vertices, 1000);
  EXPECT_GT(cube.skin_vertices, 200);
}

}  // namespace falling_skin_test
}  // namespace supple
