// Tests cloth of any triangles in scene files: fabrics, surfaces that are sewn and remeshed, the grain, selections at
// borders and points, and what is refused.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "base/error.h"
#include "scene/building/assemble.h"
#include "scene/building/warnings.h"
#include "scene/definition/fabrics.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"
#include "support/scene_text.h"

namespace supple {
namespace cloth_scene_test {

using test::problems_of;
using test::scene_of;

double total(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

double flat_area(const BodyDescription& body) {
  double area = 0;
  for (const FlatTriangle& triangle : body.cloth) area += triangle.area();
  return area;
}

// Writes an open cylinder of radius 1 and height 2 whose seam has two vertices at each place, as textures want it.
std::string open_cylinder(const std::filesystem::path& folder) {
  constexpr int around = 24, high = 6;
  std::ofstream file(folder / "tube.obj");
  for (int j = 0; j <= high; ++j) {
    for (int i = 0; i <= around; ++i) {
      const double angle = 2 * std::numbers::pi * (i % around) / around;
      file << fmt::format("v {} {} {}\n", std::cos(angle), 2.0 * j / high, std::sin(angle));
    }
  }
  for (int j = 0; j < high; ++j) {
    for (int i = 0; i < around; ++i) {
      const int a = j * (around + 1) + i + 1, b = a + 1, c = b + around + 1, d = a + around + 1;
      file << fmt::format("f {} {} {}\nf {} {} {}\n", a, d, c, a, c, b);
    }
  }
  return (folder / "tube.obj").string();
}

TEST(ClothScenes, EveryFabricHasItsDensityAndCanBeAskedForByName) {
  for (const FabricPreset& preset : fabric_presets) {
    const SceneDef scene = scene_of(
        fmt::format("[[body]]\ncloth = {{ extent = [0.5, 0.4], cells = [20, 16] }}\nmaterial = \"{}\"\n", preset.name));
    const Body body = assemble(scene).front();
    EXPECT_TRUE(body.description.springs.empty());
    EXPECT_EQ(body.description.cloth.size(), 640u);
    EXPECT_NEAR(flat_area(body.description), 0.2, 1e-12);
    EXPECT_NEAR(total(body.description.point_mass), 0.2 * preset.density, 1e-12);
    EXPECT_EQ(body.description.fabric.bending, preset.bending);
    const auto& woven = std::get<Woven>(body.description.fabric.membrane);
    EXPECT_EQ(woven.warp, preset.warp);
    EXPECT_EQ(woven.weft, preset.weft);
    const std::vector<Problem> said_of = said(warnings(scene, {body}));
    for (const Problem& problem : said_of)
      EXPECT_EQ(problem.message.find("stiff"), std::string::npos) << problem.message;
  }
}

TEST(ClothScenes, ElasticSheetsTakeYoungsModulusTimesThicknessAndThePlatesBending) {
  const SceneDef scene = scene_of(
      "[[body]]\ncloth = { extent = [1, 1], cells = [2, 2] }\n"
      "material = { model = \"neo-hookean\", young = 1e6, poisson = 0.25, thickness = 1e-3 }\n");
  const Fabric& fabric = scene.bodies[0].cloth->fabric->fabric;
  const auto& sheet = std::get<PlaneNeoHookean>(fabric.membrane);
  EXPECT_NEAR(sheet.mu, 400, 1e-9);                        // E t / (2 (1 + nu))
  EXPECT_NEAR(sheet.lambda, 1000 * 0.25 / 0.9375, 1e-9);   // E t nu / (1 - nu^2)
  EXPECT_NEAR(fabric.bending, 1e-3 / 12 / 0.9375, 1e-12);  // E t^3 / (12 (1 - nu^2))
}

TEST(ClothScenes, AFabricMayHaveOtherNumbersAndKeepsItsDensity) {
  const SceneDef scene = scene_of(
      "[[body]]\ncloth = { extent = [1, 1], cells = [2, 2] }\nmaterial = { fabric = \"silk\", warp = 500, bend = 3e-6 "
      "}\n");
  const FabricDef& fabric = *scene.bodies[0].cloth->fabric;
  const auto& woven = std::get<Woven>(fabric.fabric.membrane);
  EXPECT_EQ(woven.warp, 500);
  EXPECT_EQ(woven.weft, 250);
  EXPECT_EQ(woven.limit, 1.1);
  EXPECT_EQ(fabric.fabric.bending, 3e-6);
  EXPECT_EQ(scene.bodies[0].body_density(), 0.035);
}

TEST(ClothScenes, EdgesThatDoNotSuitASurfaceAreRefused) {
  const test::TemporaryFolder folder;
  const std::string start = fmt::format("[[body]]\ncloth = {{ surface = \"{}\", edge = ", open_cylinder(folder.path));
  for (const auto& [edge, message] : {std::pair("2", "is too long for a surface of 2 m"), {"0.001", "at most 1e+06"}}) {
    try {
      assemble(scene_of(start + edge + " }\nmaterial = \"cotton\"\n"));
      ADD_FAILURE() << edge;
    } catch (const InputError& error) {
      EXPECT_NE(error.problems().front().message.find(message), std::string::npos) << error.problems().front().message;
    }
  }
}

TEST(ClothScenes, ASurfaceIsSewnAtItsSeamAndKeepsItsBorders) {
  const test::TemporaryFolder folder;
  const std::string file = open_cylinder(folder.path);
  const std::string start = fmt::format("[[body]]\ncloth = {{ surface = \"{}\"", file);
  const Body plain = assemble(scene_of(start + " }\nmaterial = \"cotton\"\n")).front();
  EXPECT_EQ(plain.description.mesh.rest.rows(), 24 * 7);
  const double chord = 24 * 2 * std::sin(std::numbers::pi / 24);
  EXPECT_NEAR(flat_area(plain.description), 2 * chord, 1e-6);
  const Body fine = assemble(scene_of(start + ", edge = 0.1 }\nmaterial = \"cotton\"\nsize = 1\n")).front();
  // The edge is that of the finished body, which has half of the file's size.
  EXPECT_NEAR(mean_edge(fine.cloth.surface.triangles, fine.description.mesh.rest), 0.1, 0.015);
  EXPECT_NEAR(flat_area(fine.description), 0.5 * chord, 0.03);
  const Bounds box = bounds_of(fine.description.mesh.rest);
  EXPECT_NEAR(box.extent().y(), 1, 1e-9);
}

TEST(ClothScenes, TheWarpFollowsTheGrainInEveryTriangle) {
  const test::TemporaryFolder folder;
  const std::string file = open_cylinder(folder.path);
  const Body body = assemble(scene_of(fmt::format(
                                 "[[body]]\ncloth = {{ surface = \"{}\", grain = [0, 2, 0] }}\nmaterial = \"denim\"\n"
                                 "turn_deg = [0, 0, 90]\n",
                                 file)))
                        .front();
  const Positions& rest = body.description.mesh.rest;
  for (const FlatTriangle& triangle : body.description.cloth) {
    // The tube lies along -x now; the warp coordinate of an edge is its extent along the tube.
    for (int k = 0; k < 2; ++k) {
      const Vec3 edge = rest.row(triangle.corner[std::size_t(k) + 1]) - rest.row(triangle.corner[0]);
      EXPECT_NEAR(triangle.edges[k], -edge.x(), 1e-9);
      EXPECT_NEAR(std::hypot(triangle.edges[k], triangle.edges[2 + k]), edge.norm(), 1e-9);
    }
  }
}

TEST(ClothScenes, HandlesTakeBordersAndTheVerticesNearestToPoints) {
  const test::TemporaryFolder folder;
  const std::string file = open_cylinder(folder.path);
  const std::string cloth = fmt::format("[[body]]\ncloth = {{ surface = \"{}\" }}\nmaterial = \"cotton\"\n", file);
  const auto held = [&](const std::string& select) {
    return assemble(scene_of(cloth + "[[body.handles]]\nname = \"pins\"\nselect = { " + select + " }\n"))
        .front()
        .description.handles.front()
        .vertices.size();
  };
  EXPECT_EQ(held("border = true"), 48u);
  EXPECT_EQ(held("border = true, plane = { point = [0, 0.5, 0], normal = [0, 1, 0] }"), 24u);
  EXPECT_EQ(held("nearest = [[1, 1, 0.5], [0, 1, 0.5], [1, 1, 0.52]]"), 2u);
}

TEST(ClothScenes, MistakesAreNamedWithTheirPlace) {
  const std::string grid = "cloth = { extent = [1, 1], cells = [4, 4] }\n";
  const std::pair<std::string, std::string> texts[] = {
      {grid, "'material' is missing"},
      {grid + "material = \"coton\"\n", "material = 'coton': must be cotton, denim, silk, jersey or felt"},
      {grid + "material = { model = \"woven\", warp = 100 }\n", "'shear' is missing"},
      {grid + "material = { model = \"corotated\", mu = 1 }\n", "model"},
      {grid + "material = \"cotton\"\nfibre = { kappa = 3 }\n", "fibre: not of cloth"},
      {"cloth = { extent = [1, 1], cells = [4, 4], edge = 0.1 }\nmaterial = \"cotton\"\n",
       "edge: of the triangles of a"},
      {"cloth = { extent = [1, 1], cells = [4, 4], grain = [0, 0, 0] }\nmaterial = \"cotton\"\n", "grain: must not be"},
      {"cloth = { extent = [1, 1], cells = [4, 4], shear = 3 }\nmaterial = \"cotton\"\n", "shear: of springs"},
  };
  for (const auto& [text, message] : texts) {
    const std::vector<std::string> found = problems_of("[[body]]\n" + text);
    EXPECT_TRUE(std::ranges::any_of(found,
                                    [&](const std::string& one) {
                                      return one.starts_with("scene.toml:") && one.find(message) != std::string::npos;
                                    }))
        << (found.empty() ? "nothing" : found.front()) << "\nfor " << text;
  }
  const std::string hold = "[[body.handles]]\nname = \"rim\"\nselect = { border = true }\n";
  EXPECT_THROW(
      assemble(scene_of("[[body]]\nbox = { extent = [1, 1, 1], cells = [2, 2, 2] }\nmaterial = \"jelly\"\n" + hold)),
      InputError);
}

TEST(ClothScenes, AWarningTellsOfClothThatTenIterationsDoNotSolve) {
  const auto said_of = [](double warp) {
    const SceneDef scene =
        scene_of(fmt::format("[[body]]\ncloth = {{ extent = [1, 1], cells = [40, 40] }}\ndensity = 0.1\n"
                             "material = {{ model = \"woven\", warp = {}, shear = 10 }}\n",
                             warp));
    const std::vector<Body> bodies = assemble(scene);
    return std::ranges::any_of(warnings(scene, bodies),
                               [](const Warning& w) { return w.kind == WarningKind::stiffness; });
  };
  EXPECT_FALSE(said_of(1000));
  EXPECT_TRUE(said_of(40000));
}

}  // namespace cloth_scene_test
}  // namespace supple
