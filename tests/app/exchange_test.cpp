// Tests what a run leaves for other programs: surfaces in addition to the point caches, and fields with --vtu.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "output/files/child_program.h"
#include "output/files/obj_file.h"
#include "output/files/vtu.h"
#include "output/motion/point_cache.h"
#include "support/bodies.h"
#include "support/program.h"
#include "support/vtu.h"

namespace supple {
namespace exchange_test {

using test::read_vtu;
using test::Result;
using test::run;
using test::VtuFile;
using test::VtuNumbers;

// Describes a box that falls on the floor beside a cloth that a handle holds.
constexpr const char* scene = R"(frames = 12
[[body]]
name = "box"
box = { extent = [0.2, 0.1, 0.1], cells = [4, 2, 2] }
position = [0, 0.002, 0]
material = { model = "stable-neo-hookean", young = 1e5, poisson = 0.3 }
[[body]]
name = "cloth"
cloth = { extent = [0.4, 0.3], cells = [8, 6], stretch = 50, shear = 20, bend = 1 }
position = [1, 1, 0]
[[body.handles]]
name = "edge"
select = { box = [[0, 0.99, 0], [1, 1, 1]] }
[output]
energy = true
)";
constexpr const char* ground = R"([[collider]]
name = "floor"
shape = { half_space = { normal = [0, 1, 0] } }
)";

std::filesystem::path filmed(const test::TemporaryFolder& folder, const std::string& text,
                             const std::vector<std::string>& more) {
  std::ofstream(folder.path / "scene.toml") << text;
  std::vector<std::string> words = {"render", "scene.toml", "--no-images", "--quiet", "--force"};
  words.insert(words.end(), more.begin(), more.end());
  const Result result = run(folder.path, words);
  EXPECT_EQ(result.status, 0) << result.err;
  return folder.path / "out" / "scene";
}

double norm(const VtuNumbers& numbers, std::size_t row) {
  double sum = 0;
  for (int i = 0; i < numbers.components; ++i)
    sum += std::pow(numbers.values[row * std::size_t(numbers.components) + std::size_t(i)], 2);
  return std::sqrt(sum);
}

TEST(Motion, HasTheSurfaceAtRestInTheOrderOfItsPointCache) {
  const test::TemporaryFolder folder;
  const std::filesystem::path out = filmed(folder, scene, {});
  for (const auto& [body, faces] : {std::pair("box", 80), {"cloth", 96}}) {
    PointCacheReader cache(out / "motion" / (std::string(body) + ".pc2"));
    std::ifstream file(out / "motion" / (std::string(body) + ".obj"));
    std::vector<double> rest;
    int triangles = 0;
    for (std::string word; file >> word;) {
      double x = 0, y = 0, z = 0;
      file >> x >> y >> z;
      if (word == "v") rest.insert(rest.end(), {x, y, z});
      if (word == "f") {
        ++triangles;
        EXPECT_LE(std::max({x, y, z}), cache.points());
        EXPECT_GE(std::min({x, y, z}), 1);
      }
    }
    EXPECT_EQ(triangles, faces);
    ASSERT_EQ(rest.size(), 3 * std::size_t(cache.points()));
    // After one step of free fall nothing but the handle's neighbours has moved by more than g h^2.
    const Positions first = cache.frame(0);
    for (Eigen::Index i = 0; i < first.size(); ++i) EXPECT_NEAR(first.data()[i], rest[std::size_t(i)], 9.82 / 900);
  }
}

TEST(Motion, KeepsTheShapeOfABodyFarFromTheOrigin) {
  const test::TemporaryFolder folder;
  const std::string near =
      "frames = 2\ngravity = [0, 0, 0]\n[[body]]\nname = \"box\"\nmaterial = \"jelly\"\n"
      "box = { extent = [0.2, 0.1, 0.1], cells = [4, 2, 2] }\n";
  const std::filesystem::path far = filmed(folder, near + "position = [200000.03, 7, -3]\n", {});
  const Vec3 origin = origin_of_obj(far / "motion" / "box.obj");
  EXPECT_NEAR(origin.x(), 2e5, 1);
  const Positions there = PointCacheReader(far / "motion" / "box.pc2").frame(1);
  (void)filmed(folder, near, {"--out", "near"});
  EXPECT_EQ(origin_of_obj(folder.path / "near" / "motion" / "box.obj"), Vec3::Zero());
  const Positions here = PointCacheReader(folder.path / "near" / "motion" / "box.pc2").frame(1);
  EXPECT_LT(((there.rowwise() + (origin - Vec3(200000.03, 7, -3)).transpose()) - here).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Vtu, GivesBackItsArrays) {
  const test::TemporaryFolder folder;
  const std::vector<double> points = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1e-300};
  const std::vector<std::int32_t> corners = {0, 1, 2, 3, 3, 2, 1, 0};
  const std::vector<float> warm = {1.5f, -2, 3, 4};
  const std::vector<std::uint8_t> flags = {255, 7};
  VtuGrid grid{
      points,
      corners,
      4,
      {{"warm <&>", 1, std::span<const float>(warm)}},
      {{"flag", 1, std::span<const std::uint8_t>(flags)}, {"corner", 4, std::span<const std::int32_t>(corners)}}};
  write_vtu(folder.path / "a.vtu", grid);
  const VtuFile file = read_vtu(folder.path / "a.vtu");
  EXPECT_EQ(file.points, 4);
  EXPECT_EQ(file.cells, 2);
  EXPECT_EQ(file.position.values, points);
  EXPECT_EQ(file.position.type, "Float64");
  EXPECT_EQ(file.point_data.at("warm &lt;&amp;&gt;").values, (std::vector<double>{1.5, -2, 3, 4}));
  EXPECT_EQ(file.cell_data.at("flag").values, (std::vector<double>{255, 7}));
  EXPECT_EQ(file.cell_data.at("corner").components, 4);
  EXPECT_EQ(file.cell_arrays.at("connectivity").values, (std::vector<double>{0, 1, 2, 3, 3, 2, 1, 0}));
  EXPECT_EQ(file.cell_arrays.at("offsets").values, (std::vector<double>{4, 8}));
  EXPECT_EQ(file.cell_arrays.at("types").values, (std::vector<double>{10, 10}));
}

TEST(Fields, AreWrittenEveryFewFramesWithACollection) {
  const test::TemporaryFolder folder;
  const std::filesystem::path out = filmed(folder, std::string(scene) + ground, {"--vtu", "5"});
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(out / "fields"))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"box-000000.vtu", "box-000005.vtu", "box-000010.vtu", "box.pvd",
                                             "cloth-000000.vtu", "cloth-000005.vtu", "cloth-000010.vtu", "cloth.pvd"}));
  const test::XmlElement collection = test::read_xml(out / "fields" / "box.pvd");
  EXPECT_EQ(collection.attributes.at("type"), "Collection");
  const auto& sets = collection.child("Collection").children;
  ASSERT_EQ(sets.size(), 3u);
  EXPECT_EQ(sets[1].attributes.at("file"), "box-000005.vtu");
  EXPECT_NEAR(std::stod(sets[1].attributes.at("timestep")), 6 / 30.0, 1e-12);
}

TEST(Fields, OfAFilmThatGoesOnStandInOneCollection) {
  const test::TemporaryFolder folder;
  const std::filesystem::path out = filmed(folder, scene, {"--vtu", "4", "--frames", "6"});
  filmed(folder, scene, {"--vtu", "4", "--resume"});
  const test::XmlElement collection = test::read_xml(out / "fields" / "box.pvd");
  const auto& sets = collection.child("Collection").children;
  ASSERT_EQ(sets.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sets[i].attributes.at("file"), fmt::format("box-{:06}.vtu", 4 * i));
    EXPECT_NEAR(std::stod(sets[i].attributes.at("timestep")), double(4 * i + 1) / 30, 1e-12);
  }
}

TEST(Fields, AgreeWithTheProfileAndTheMotion) {
  const test::TemporaryFolder folder;
  const std::filesystem::path out = filmed(folder, std::string(scene) + ground, {"--vtu", "1"});
  const auto row = test::profile_of(out)["frames"][10]["bodies"];
  const VtuFile box = read_vtu(out / "fields" / "box-000010.vtu");
  EXPECT_EQ(box.points, 45);
  EXPECT_EQ(box.cell_data.at("stretch").components, 3);
  const double volume = 0.2 * 0.1 * 0.1;
  double energy = 0, largest = 0;
  for (int cell = 0; cell < box.cells; ++cell) {
    // Cells of the grid differ in volume; the corners at rest are position minus displacement.
    Eigen::Matrix<double, 3, 4> corner;
    for (int k = 0; k < 4; ++k) {
      const auto v = std::size_t(box.cell_arrays.at("connectivity").values[std::size_t(4 * cell + k)]);
      for (std::size_t i = 0; i < 3; ++i)
        corner(Eigen::Index(i), k) =
            box.position.values[3 * v + i] - box.point_data.at("displacement").values[3 * v + i];
    }
    const Vec3 a = corner.col(1) - corner.col(0), b = corner.col(2) - corner.col(0), c = corner.col(3) - corner.col(0);
    EXPECT_GT(a.cross(b).dot(c), 0.01 * volume / box.cells);
    energy += a.cross(b).dot(c) / 6 * box.cell_data.at("energy_density").values[std::size_t(cell)];
    largest = std::max(largest, box.cell_data.at("stretch").values[std::size_t(3 * cell)]);
    EXPECT_GE(box.cell_data.at("von_mises").values[std::size_t(cell)], 0);
  }
  const double elastic = row[0]["elastic_energy"];
  EXPECT_NEAR(energy, elastic, 1e-5 * elastic);  // displacements are single precision
  EXPECT_GE(largest, row[0]["stretch"].get<double>() - 1e-6);
  int touching = 0;
  double upward = 0;
  for (std::size_t v = 0; v < 45; ++v) {
    touching += norm(box.point_data.at("contact_force"), v) > 0;
    upward += box.point_data.at("contact_force").values[3 * v + 1];
  }
  EXPECT_GT(touching, 0);
  EXPECT_LE(touching, row[0]["contacts"].get<int>());
  EXPECT_GT(upward, 0);

  const VtuFile cloth = read_vtu(out / "fields" / "cloth-000010.vtu");
  EXPECT_EQ(cloth.cell_arrays.at("types").values, std::vector<double>(96, 5));
  EXPECT_EQ(cloth.cell_data.at("stretch").components, 2);
  double springs = 0;
  for (const double part : cloth.point_data.at("spring_energy").values) springs += part;
  EXPECT_NEAR(springs, row[1]["elastic_energy"].get<double>(), 1e-9 * springs);
}

TEST(Fields, ChangeNoResultAndHaveNoForcesWhereNothingTouches) {
  const test::TemporaryFolder folder;
  std::filesystem::path out = filmed(folder, scene, {});
  EXPECT_FALSE(std::filesystem::exists(out / "fields"));
  const auto hash = [](const std::filesystem::path& at) {
    return test::profile_of(at)["frames"].back()["state_hash"].get<std::string>();
  };
  const std::string without = hash(out);
  out = filmed(folder, scene, {"--vtu", "4", "--error-every", "3"});
  EXPECT_EQ(hash(out), without);
  const VtuFile box = read_vtu(out / "fields" / "box-000008.vtu");
  EXPECT_EQ(norm(box.point_data.at("contact_force"), 0), 0) << "the cloth might touch it";
  EXPECT_EQ(box.point_data.size(), 3u);
  // In free fall nothing is strained: every vertex moves by g h^2 n (n + 1) / 2 after n steps.
  const double h = 1 / 30.0;
  EXPECT_NEAR(norm(box.point_data.at("displacement"), 0), 9.81 * h * h * 9 * 10 / 2, 1e-4);
  EXPECT_NEAR(norm(box.point_data.at("velocity"), 0), 9.81 * h * 9, 1e-4);
  filmed(folder, scene, {});
  EXPECT_FALSE(std::filesystem::exists(out / "fields")) << "an earlier run's fields are gone";
}

TEST(Documentation, NamesEveryFieldThatIsWritten) {
  const test::TemporaryFolder folder;
  const std::filesystem::path out = filmed(folder, std::string(scene) + ground, {"--vtu", "20"});
  const std::string page = test::read_file(test::source_folder / "docs" / "exchange.md");
  int checked = 0;
  for (const char* body : {"box", "cloth"}) {
    const VtuFile file = read_vtu(out / "fields" / (std::string(body) + "-000000.vtu"));
    for (const auto* arrays : {&file.point_data, &file.cell_data}) {
      for (const auto& [name, numbers] : *arrays) {
        const std::string type =
            numbers.components == 1 ? numbers.type : fmt::format("{} x {}", numbers.components, numbers.type);
        const std::size_t line = page.find("\n| `" + name + "` | ");
        ASSERT_NE(line, std::string::npos) << name;
        EXPECT_NE(page.find("| " + type + " |", line), std::string::npos) << name << " as " << type;
        ++checked;
      }
    }
  }
  EXPECT_EQ(checked, 3 + 3 + 4 + 1);
}

TEST(Fields, AreReadByMeshio) {
  const auto there = run_program({"/usr/bin/python3", "-c", "import meshio"});
  if (!there || there->status != 0) GTEST_SKIP() << "no meshio (Debian: python3-meshio)";
  const test::TemporaryFolder folder;
  const std::filesystem::path out = filmed(folder, std::string(scene) + ground, {"--vtu", "11"});
  const auto told = [&](const char* body) {
    const std::string program = fmt::format(
        "import meshio; m = meshio.read('{}'); print(len(m.points), [(c.type, len(c.data)) for c in m.cells], "
        "sorted(m.point_data), sorted(m.cell_data))",
        (out / "fields" / (std::string(body) + "-000011.vtu")).string());
    return run_program({"/usr/bin/python3", "-c", program})->output;
  };
  const int box = read_vtu(out / "fields" / "box-000011.vtu").cells;
  EXPECT_EQ(told("box"), fmt::format("45 [('tetra', {})] ['contact_force', 'displacement', 'velocity'] "
                                     "['energy_density', 'stretch', 'von_mises']\n",
                                     box));
  EXPECT_EQ(told("cloth"),
            "63 [('triangle', 96)] ['contact_force', 'displacement', 'spring_energy', 'velocity'] ['stretch']\n");
}

// Describes a ball whose skin is finer than its elements, beside a cloth.
constexpr const char* skinned = R"(frames = 6
[[body]]
name = "ball"
shape = "shapes/sphere.toml"
vertices = 200
skin_cells = 24
size = 0.2
material = "jelly"
[[body]]
name = "cloth"
cloth = { extent = [0.4, 0.3], cells = [4, 3], stretch = 50, shear = 20, bend = 1 }
position = [1, 1, 0]
[[collider]]
shape = { half_space = { normal = [0, 1, 0] } }
)";

TEST(Skins, AreWrittenWithTheirMotionForChosenFrames) {
  const test::TemporaryFolder folder;
  const std::filesystem::path film = filmed(folder, skinned, {});
  const Result result =
      run(folder.path, {"draw", film.string(), "--skins", "--every", "2", "--last", "4", "--out", "s"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("3 frames of 2 skins"), std::string::npos) << result.out;
  PointCacheReader mesh(film / "motion" / "ball.pc2"), skin(folder.path / "s" / "motion" / "ball.pc2");
  EXPECT_GT(skin.points(), 3 * mesh.points());
  ASSERT_EQ(skin.frames(), 3);
  for (int sample = 0; sample < 3; ++sample) {
    const Positions surface = skin.frame(sample), elements = mesh.frame(2 * sample);
    EXPECT_LT((surface.colwise().mean() - elements.colwise().mean()).norm(), 0.02);
    EXPECT_NEAR(bounds_of(surface).lower.y(), bounds_of(elements).lower.y(), 0.02);
  }
  EXPECT_GT(skin.frame(0).col(1).mean() - skin.frame(2).col(1).mean(), 1e-3);  // it falls
  // Of cloth, the skin is the mesh: each of its points is one of the mesh's.
  PointCacheReader threads(film / "motion" / "cloth.pc2"), sheet(folder.path / "s" / "motion" / "cloth.pc2");
  const Positions at = threads.frame(4), drawn = sheet.frame(2);
  for (const auto& point : drawn.rowwise()) EXPECT_LT((at.rowwise() - point).rowwise().norm().minCoeff(), 1e-6);
  EXPECT_EQ(test::read_file(folder.path / "s" / "motion" / "ball.obj").substr(0, 2), "v ");
}

TEST(Skins, LeaveOtherFoldersAlone) {
  const test::TemporaryFolder folder;
  const std::filesystem::path film = filmed(folder, skinned, {"--frames", "1"});
  std::filesystem::create_directories(folder.path / "mine");
  std::ofstream(folder.path / "mine" / "notes.txt") << "mine";
  const Result refused = run(folder.path, {"draw", film.string(), "--skins", "--out", "mine"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("holds files that no skins left there"), std::string::npos) << refused.err;
  const Result one = run(folder.path, {"draw", film.string(), "--skins", "--frame", "0"});
  EXPECT_EQ(one.status, 2);
  EXPECT_NE(one.err.find("--skins: writes all chosen frames"), std::string::npos) << one.err;
  const Result field = run(folder.path, {"draw", film.string(), "--skins", "--field", "stretch"});
  EXPECT_EQ(field.status, 2);
  EXPECT_NE(field.err.find("--skins: writes shapes, and not pictures"), std::string::npos) << field.err;
  for (int again = 0; again < 2; ++again)
    EXPECT_EQ(run(folder.path, {"draw", film.string(), "--skins", "--quiet", "--out", "s"}).status, 0);
}

}  // namespace exchange_test
}  // namespace supple
