// Tests the values and the ranges of fields on surfaces, at poses whose fields are known.
#include "film/pictures/surface_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "geometry/meshes/cloth.h"
#include "sim/measures/fields.h"
#include "support/film.h"
#include "support/scene_text.h"

namespace supple {
namespace surface_field_test {

// Holds a bar, a cloth and a ground, with one quantity.
struct Fixture {
  test::TemporaryFolder folder;
  std::unique_ptr<test::Film> film;
  std::vector<Positions> motion;

  explicit Fixture(const std::string& quantity, const std::vector<std::string>& more = {}) {
    const std::filesystem::path path = folder.path / "scene.toml";
    std::ofstream(path) << R"([[body]]
name = "bar"
box = { extent = [1, 0.5, 0.5], cells = [4, 2, 2] }
material = { model = "neo-hookean", mu = 1e4, lambda = 2e4 }
position = [0, 1, 0]
[[body]]
name = "sheet"
cloth = { extent = [1, 1], cells = [4, 4], stretch = 10, bend = 1 }
[[collider]]
name = "ground"
shape = { half_space = { normal = [0, 1, 0] } }
)";
    std::vector<std::string> settings = {"field.quantity=" + quantity};
    settings.insert(settings.end(), more.begin(), more.end());
    film = std::make_unique<test::Film>(path, settings);
    for (const Body& body : film->bodies) motion.push_back(body.description.mesh.rest);
  }
  FramePose pose(const std::vector<Positions>& before = {}) const {
    FramePose pose{0, 0, {}, {}};
    for (const Positions& body : motion) pose.motion.push_back(&body);
    for (const Positions& body : before) pose.before.push_back(&body);
    return pose;
  }
  std::vector<std::vector<double>> values(SurfaceField& field, const std::vector<Positions>& before = {}) const {
    return field.values(pose(before), film->set, nullptr);
  }
};

TEST(SurfaceField, IsTheStretchOfSolidsAndOfCloth) {
  Fixture fixture("stretch");
  SurfaceField field(fixture.film->scene, fixture.film->bodies);
  fixture.motion[0].col(0) *= 1.5;
  fixture.motion[1].col(0) *= 1.25;
  const auto values = fixture.values(field);
  ASSERT_EQ(values[0].size(), std::size_t(fixture.motion[0].rows()));
  for (const double value : values[0]) EXPECT_NEAR(value, 1.5, 1e-12);
  for (const double value : values[1]) EXPECT_NEAR(value, 1.25, 1e-9);
}

TEST(SurfaceField, IsTheVolumeAndTheAreaOverThoseAtRest) {
  Fixture fixture("volume");
  SurfaceField field(fixture.film->scene, fixture.film->bodies);
  for (Positions& body : fixture.motion) body *= 0.9;
  const auto values = fixture.values(field);
  for (const double value : values[0]) EXPECT_NEAR(value, 0.9 * 0.9 * 0.9, 1e-12);
  for (const double value : values[1]) EXPECT_NEAR(value, 0.9 * 0.9, 1e-9);
}

TEST(SurfaceField, IsTheSpeedSinceTheFrameBefore) {
  Fixture fixture("speed", {"fps=20"});
  SurfaceField field(fixture.film->scene, fixture.film->bodies);
  ASSERT_TRUE(field.needs_before());
  std::vector<Positions> before = fixture.motion;
  for (Positions& body : fixture.motion) body.col(2).array() += 0.1;
  for (const auto& body : fixture.values(field, before)) {
    for (const double value : body) EXPECT_NEAR(value, 2, 1e-9);
  }
}

TEST(SurfaceField, IsTheDepthBelowTheGround) {
  Fixture fixture("depth");
  SurfaceField field(fixture.film->scene, fixture.film->bodies);
  fixture.motion[0].col(1).array() -= 1.2;
  const auto values = fixture.values(field);
  for (Eigen::Index v = 0; v < fixture.motion[0].rows(); ++v)
    EXPECT_NEAR(values[0][v], std::max(0.0, -fixture.motion[0](v, 1)), 1e-12);
}

TEST(SurfaceField, IsTheContactForceOverTheAreaOfEachVertex) {
  Fixture fixture("force");
  SurfaceField field(fixture.film->scene, fixture.film->bodies);
  ASSERT_TRUE(field.needs_forces());
  const auto before = fixture.values(field);
  for (const double value : before[0]) EXPECT_EQ(value, 0) << "there are no forces yet";
  std::vector<Positions> forces;
  for (const Positions& body : fixture.motion) forces.push_back(Positions::Zero(body.rows(), 3));
  // A third of the area of a sheet's triangles belongs to each corner; a vertex in the middle has that of a cell.
  const Positions& rest = fixture.film->bodies[1].description.mesh.rest;
  const Vec3 middle = rest.colwise().mean();
  Eigen::Index vertex = 0;
  (rest.rowwise() - middle.transpose()).rowwise().squaredNorm().minCoeff(&vertex);
  forces[1].row(vertex) << 3, 4, 0;
  FramePose pose = fixture.pose();
  for (const Positions& body : forces) pose.forces.push_back(&body);
  const auto values = field.values(pose, fixture.film->set, nullptr);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    if (v != vertex) {
      EXPECT_EQ(values[1][v], 0);
    }
  }
  double area = 0;
  for (const double share : vertex_areas({rest, fixture.film->bodies[1].cloth.surface.triangles})) area += share;
  EXPECT_NEAR(area, 1, 1e-12);
  EXPECT_NEAR(values[1][vertex], 5 * 16, 5 * 16 * 0.34) << "an inner vertex has 2/3 to 4/3 of a cell";
}

// The pressures that are shown, multiplied by their areas, add up to the weight of a cube that has come to rest.
TEST(SurfaceField, ContactForcesOfABodyAtRestAddUpToItsWeight) {
  test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path / "scene.toml";
  std::ofstream(path) << R"(field = { quantity = "force" }
[[body]]
name = "cube"
box = { extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }
material = { model = "neo-hookean", mu = 5e4, lambda = 1e5 }
density = 1000
[solver]
damping = 0.05
iterations = 30
[[collider]]
name = "ground"
shape = { half_space = { normal = [0, 1, 0] } }
)";
  const test::Film film(path, {});
  Positions forces, motion;
  film.play(1, 120, [&](std::size_t, int, const State&, const StepInputs&, const State& to, const OpenWorkspace& w) {
    forces = contact_forces(film.models[0], w, to.x);
    motion = in_input_order(film.models[0], to.x);
  });
  SurfaceField field(film.scene, film.bodies);
  FramePose pose{119, 4, {&motion}, {}, {&forces}};
  const std::vector<double> values = field.values(pose, film.set, nullptr)[0];
  const TetMesh& mesh = film.bodies[0].description.mesh;
  const std::vector<double> areas = vertex_areas({mesh.rest, boundary_faces(mesh.tets)});
  double sum = 0;
  for (std::size_t v = 0; v < values.size(); ++v) sum += values[v] * areas[v];
  const double weight = 1000 * 0.008 * 9.81;
  EXPECT_NEAR(sum, weight, 1e-3 * weight);
  EXPECT_NEAR(forces.col(1).sum(), weight, 1e-3 * weight);
}

TEST(SurfaceField, LeavesOutBodiesThatDoNotHaveIt) {
  Fixture fixture("stress");
  const SurfaceField field(fixture.film->scene, fixture.film->bodies);
  EXPECT_TRUE(field.shown_on(0));
  EXPECT_FALSE(field.shown_on(1));
  std::vector<Body> cloths = {fixture.film->bodies[1]};
  EXPECT_THROW(SurfaceField(fixture.film->scene, cloths), InputError);
}

TEST(SurfaceField, HasTheRangeThatIsGivenOrThatOfTheWholeFilm) {
  Fixture fixture("stretch", {"field.range=[0.5, 3]"});
  SurfaceField given(fixture.film->scene, fixture.film->bodies);
  EXPECT_EQ(given.range(), Eigen::Vector2d(0.5, 3));
  Fixture automatic("stretch");
  SurfaceField field(automatic.film->scene, automatic.film->bodies);
  EXPECT_EQ(field.range(), Eigen::Vector2d(1, 2));
  for (const double stretch : {1.2, 1.41, 1.1}) {
    automatic.motion[0] = automatic.film->bodies[0].description.mesh.rest;
    automatic.motion[0].col(0) *= stretch;
    field.include(automatic.values(field));
  }
  field.settle();
  EXPECT_NEAR(field.range().x(), 1, 1e-12);
  EXPECT_NEAR(field.range().y(), 1.5, 1e-12);  // 0.41 is rounded up to 0.5
}

TEST(SurfaceField, GoesToTheSkinWithinItsRange) {
  Fixture fixture("stretch", {"field.range=[1, 3]"});
  const SurfaceField field(fixture.film->scene, fixture.film->bodies);
  DrawnBody drawn;
  drawn.vertex_of = {0, 2, 1, 0};
  const double undefined = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field.on_skin(drawn, {2, undefined, 9}), (std::vector<float>{0.5f, 1.0f, no_field, 0.5f}));
  DrawnBody carried;  // a point in an element, and one outside that follows two vertices
  Embedding& embedding = carried.embedding;
  embedding.corners = Tetrahedra::Zero(2, 4);
  embedding.corners.row(0) << 0, 1, 2, 3;
  embedding.weights.setZero(2, 4);
  embedding.weights.row(0) << 0.5, 0.25, 0.25, 0;
  embedding.begin = {0, 0, 2};
  embedding.shares = {{0, 0.5}, {1, 0.5}};
  embedding.frames.vertex = {0, 2};
  EXPECT_EQ(field.on_skin(carried, {1, 3, 2, 3}), (std::vector<float>{0.375f, 0.25f}));
}

TEST(SurfaceField, HasALegendThatReadsWell) {
  EXPECT_EQ(rounded_up(0.041), 0.05);
  EXPECT_EQ(rounded_up(2), 2);
  EXPECT_NEAR(rounded_up(5.1), 10, 1e-12);
  std::vector<std::string> texts;
  for (const auto& [place, text] : ticks_between(0, 2, 1)) texts.push_back(text);
  EXPECT_EQ(texts, (std::vector<std::string>{"0", "0.5", "1", "1.5", "2"}));
  Fixture fixture("stress", {"field.range=[0, 20000]"});
  const FieldLook look = SurfaceField(fixture.film->scene, fixture.film->bodies).look();
  EXPECT_EQ(look.title, "von Mises stress [kPa]");
  EXPECT_EQ(look.ticks.back().second, "20");
  EXPECT_EQ(look.ticks.back().first, 1);
  Fixture silent("stress", {"field.legend=false"});
  EXPECT_EQ(SurfaceField(silent.film->scene, silent.film->bodies).look().title, "");
}

TEST(SurfaceField, RefusesARangeThatRunsBackwards) {
  for (const auto& [text, expected] : std::vector<std::pair<std::string, std::string>>{
           {"quantity = \"strech\"", "did you mean 'stretch'?"},
           {"range = [2, 1]", "range: the first number must be below the second"},
           {"range = [2, 1, 3]", "range = [2, 1, 3]: must be usual or film, or two numbers"},
           {"quantity = \"distance\"", "distance needs a reference"},
           {"reference = \"out/a\"", "reference: is used by quantity = \"distance\" alone"},
           {"colors = \"jet\"", "colors = 'jet': must be usual, viridis, blue-yellow or blue-orange"}}) {
    const std::vector<std::string> problems = test::problems_of(
        "[[body]]\nbox = { extent = [1, 1, 1], cells = [1, 1, 1] }\nmaterial = { model = \"neo-hookean\", mu = 1e4, "
        "lambda = 1e4 }\n[field]\n" +
        text + "\n");
    ASSERT_EQ(problems.size(), 1u) << text;
    EXPECT_NE(problems[0].find(expected), std::string::npos) << problems[0];
    EXPECT_TRUE(problems[0].starts_with("scene.toml:5:")) << problems[0];
  }
}

}  // namespace surface_field_test
}  // namespace supple
