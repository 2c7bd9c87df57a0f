#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "baselines/make_rule.h"
#include "scene/building/solver_warnings.h"
#include "scene/building/warnings.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"
#include "support/played_world.h"
#include "support/scene_text.h"

namespace supple {
namespace method_test {

// Returns a scene of one body with these lines in [solver].
Config scene_with(const std::string& lines) {
  return Config::parse("[solver]\n" + lines + "\n[[body]]\nbox = { extent = [1, 1, 1] }\nmaterial = \"jelly\"\n",
                       "scene.toml", test::assets);
}

SolverDef solver_of(const std::string& lines) {
  Config config = scene_with(lines);
  const SceneDef scene = read_scene(config);
  config.finish();
  return scene.bodies.front().solver;
}

std::string refusal(const std::string& lines) {
  try {
    (void)solver_of(lines);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Method, IsReadBackFromItsSpelling) {
  for (const Method& method : compared_methods())
    EXPECT_EQ(solver_of("method = " + spelling_of(method)).method, method) << spelling_of(method);
  EXPECT_EQ(solver_of("").method, Method::quasi_newton);
}

TEST(Method, HasADifferentNameForEveryCombination) {
  std::set<std::string> names, spellings;
  for (const Method& method : compared_methods()) {
    names.insert(name_of(method));
    spellings.insert(spelling_of(method));
  }
  EXPECT_EQ(names.size(), compared_methods().size());
  EXPECT_EQ(spellings.size(), compared_methods().size());
  EXPECT_EQ(name_of(Method::newton), "newton");
  EXPECT_EQ(name_of(Method::newton_shifted), "hessian, shift");
  EXPECT_EQ(name_of(Method::frame_cg(5, Preconditioner::rest)), "frame-hessian, 5 cg (rest)");
  EXPECT_EQ(name_of(Method{.matrix = StartMatrix::identity, .acceleration = Acceleration::none}),
            "identity, not accelerated");
}

TEST(Method, PartsThatAreLeftOutAreTheUsualOnes) {
  EXPECT_EQ(solver_of("method = { matrix = \"system\" }").method, Method::quasi_newton);
  EXPECT_EQ(solver_of("method = { matrix = \"hessian\" }").method, Method::newton);
  EXPECT_EQ(solver_of("method = { matrix = \"hessian\", linear = \"cg\" }").method, Method::newton_cg(15));
  EXPECT_EQ(solver_of("method = { matrix = \"frame-hessian\", linear = \"cg\" }").method,
            Method::frame_cg(15, Preconditioner::system));
  EXPECT_EQ(solver_of("method = { matrix = \"system\", acceleration = \"chebyshev\" }").method, Method::chebyshev);
}

TEST(Method, FormerWordsAreRefusedWithTheirNewSpelling) {
  const std::vector<std::array<std::string, 2>> words = {
      {"newton-shifted", R"({ matrix = "hessian", safeguard = "shift" })"},
      {"newton-cg5", R"({ matrix = "hessian", linear = "cg", inner_iterations = 5 })"},
      {"newton-cg15", R"({ matrix = "hessian", linear = "cg", inner_iterations = 15 })"},
      {"quasi-newton-cg5", R"({ matrix = "system", linear = "cg", inner_iterations = 5 })"},
      {"quasi-newton-cg15", R"({ matrix = "system", linear = "cg", inner_iterations = 15 })"},
      {"lbfgs-identity", R"({ matrix = "identity" })"},
      {"lbfgs-rest", R"({ matrix = "rest-hessian" })"},
      {"lbfgs-warped", R"({ matrix = "warped-rest-hessian" })"},
      {"lbfgs-frame", R"({ matrix = "frame-hessian" })"},
      {"lbfgs-frame-cg5-rest",
       R"({ matrix = "frame-hessian", linear = "cg", inner_iterations = 5, preconditioner = "rest" })"},
      {"lbfgs-frame-cg15-rest",
       R"({ matrix = "frame-hessian", linear = "cg", inner_iterations = 15, preconditioner = "rest" })"},
      {"lbfgs-frame-cg5-ours",
       R"({ matrix = "frame-hessian", linear = "cg", inner_iterations = 5, preconditioner = "system" })"},
      {"lbfgs-frame-cg15-ours",
       R"({ matrix = "frame-hessian", linear = "cg", inner_iterations = 15, preconditioner = "system" })"},
  };
  for (const auto& [word, spelling] : words) {
    EXPECT_EQ(refusal("method = \"" + word + "\""),
              "scene.toml:2:10: method = '" + word + "': is now written method = " + spelling);
    EXPECT_EQ(refusal("method = " + spelling), "accepted");
  }
}

TEST(SolverMatrix, HasTheWordsOfTheMethodsMatrices) {
  EXPECT_EQ(solver_of("").settings.matrix, StartMatrix::system);
  EXPECT_EQ(solver_of("matrix = \"system\"").settings.matrix, StartMatrix::system);
  EXPECT_EQ(solver_of("matrix = \"tangent\"").settings.matrix, StartMatrix::tangent);
  EXPECT_EQ(solver_of("matrix = \"turned-hessian\"").settings.matrix, StartMatrix::turned_hessian);
  EXPECT_EQ(refusal("matrix = \"rest-hessian\""),
            "scene.toml:2:10: matrix = 'rest-hessian': must be system, tangent or turned-hessian; did you mean "
            "'turned-hessian'?");
}

TEST(SolverMatrix, FormerWordsAreRefusedWithTheirNewSpelling) {
  EXPECT_EQ(refusal("matrix = \"constant\""),
            "scene.toml:2:10: matrix = 'constant': is now written matrix = \"system\"");
  EXPECT_EQ(refusal("matrix = \"hessian\""),
            "scene.toml:2:10: matrix = 'hessian': is now written matrix = \"turned-hessian\"");
}

TEST(Solver, WordsForWhatExistsNoMoreAreRefusedWithTheNearest) {
  EXPECT_EQ(refusal("line_search = \"wolfe\""),
            "scene.toml:2:15: line_search = 'wolfe': exists no more; nearest is line_search = \"armijo\"");
  EXPECT_EQ(
      refusal("method = \"hecht\""),
      "scene.toml:2:10: method = 'hecht': exists no more; nearest is method = { matrix = \"warped-rest-hessian\" }");
  EXPECT_EQ(refusal("method = { matrix = \"hecht\" }"),
            "scene.toml:2:21: matrix = 'hecht': exists no more; nearest is matrix = \"warped-rest-hessian\"");
  EXPECT_EQ(refusal("method = \"contact-matrix\""),
            "scene.toml:2:10: method = 'contact-matrix': exists no more; nearest is method = \"quasi-newton\"");
  EXPECT_EQ(refusal("method = { matrix = \"contact\" }"),
            "scene.toml:2:21: matrix = 'contact': exists no more; nearest is matrix = \"system\"");
  EXPECT_EQ(refusal("contact = { direction = \"ignored\" }"),
            "scene.toml:2:25: direction = 'ignored': exists no more; nearest is direction = \"low-rank\"");
  EXPECT_EQ(refusal("contact = { history = \"frozen\" }"),
            "scene.toml:2:23: history: exists no more; all pairs of L-BFGS have the contacts in force now");
}

TEST(Method, HasNoMatrixOfItsOwnForWhatQuasiNewtonHas) {
  EXPECT_EQ(refusal("method = { matrix = \"tangent\" }"),
            "scene.toml:2:21: matrix = 'tangent': must be system, identity, rest-hessian, warped-rest-hessian, "
            "frame-hessian, hessian or vertex-blocks");
}

TEST(Method, PartsThatDoNotGoTogetherAreRefusedWithWhatDoes) {
  EXPECT_EQ(refusal("method = { matrix = \"identity\", linear = \"cg\" }"),
            "scene.toml:2:42: linear = 'cg': with matrix = 'identity' it must be direct");
  EXPECT_EQ(refusal("method = { matrix = \"frame-hessian\", linear = \"cg\", preconditioner = \"jacobi\" }"),
            "scene.toml:2:70: preconditioner = 'jacobi': with matrix = 'frame-hessian' and linear = 'cg' it must be "
            "system or rest");
  EXPECT_EQ(refusal("method = { matrix = \"hessian\", acceleration = \"l-bfgs\" }"),
            "scene.toml:2:47: acceleration = 'l-bfgs': with matrix = 'hessian' and linear = 'direct' it must be none");
  EXPECT_EQ(refusal("method = { matrix = \"rest-hessian\", acceleration = \"chebyshev\" }"),
            "scene.toml:2:52: acceleration = 'chebyshev': with matrix = 'rest-hessian' and linear = 'direct' it must "
            "be l-bfgs or none");
  EXPECT_EQ(refusal("method = { matrix = \"hessian\", safeguard = \"curvature\" }"),
            "scene.toml:2:44: safeguard = 'curvature': with matrix = 'hessian' and linear = 'direct' it must be "
            "projection, on-demand or shift");
  EXPECT_EQ(refusal("method = { matrix = \"system\", inner_iterations = 5 }"),
            "scene.toml:2:50: inner_iterations: only with linear = \"cg\"");
  EXPECT_EQ(refusal("method = { matrix = \"system\", linear = \"cg\", inner_tolerance = 0.1 }"),
            "scene.toml:2:64: inner_tolerance = 0.1: must be 0 but with matrix = 'hessian' and linear = 'cg'");
  EXPECT_EQ(refusal("method = { linear = \"cg\" }"),
            "scene.toml:2:10: 'matrix' is missing: what a search direction starts from (system, identity, "
            "rest-hessian, warped-rest-hessian, frame-hessian, hessian or vertex-blocks)");
  EXPECT_EQ(refusal("method = \"newtn\""),
            "scene.toml:2:10: method = 'newtn': must be quasi-newton, projective-dynamics, chebyshev, newton, gast, "
            "vertex-block-descent or admm; did you mean 'newton'?");
  EXPECT_EQ(refusal("method = { matrix = \"hesian\" }"),
            "scene.toml:2:21: matrix = 'hesian': must be system, identity, rest-hessian, warped-rest-hessian, "
            "frame-hessian, hessian or vertex-blocks; did you mean 'hessian'?");
}

TEST(Method, PartsCanBeSetByTheirPaths) {
  const auto method_with = [](const std::vector<std::string>& settings) {
    Config config = scene_with("method = { matrix = \"frame-hessian\", linear = \"cg\" }");
    for (const std::string& setting : settings) config.set(setting, exclusive_keys());
    const SceneDef scene = read_scene(config);
    config.finish();
    return scene.bodies.front().solver.method;
  };
  EXPECT_EQ(method_with({"solver.method.inner_iterations=5", "solver.method.preconditioner=rest"}),
            Method::frame_cg(5, Preconditioner::rest));
  EXPECT_EQ(method_with({"solver.method=newton"}), Method::newton);
  EXPECT_EQ(method_with({"solver.method={ matrix = \"identity\" }"}), Method::lbfgs_from(StartMatrix::identity));
  EXPECT_EQ(method_with({"body.body.solver.method=gast"}), Method::gast);
}

TEST(Chebyshev, WithoutAnIterationLeftToAccelerateIsWarnedOf) {
  const auto warning = [](const std::string& lines) {
    Config config = Config::parse(
        "gravity = [0, 0, 0]\n[solver]\n" + lines + "\n[[body]]\nbox = { extent = [1, 1, 1] }\nmaterial = \"jelly\"\n",
        "scene.toml", test::assets);
    const SceneDef scene = read_scene(config);
    config.finish();
    const std::vector<Problem> list = said(warnings(scene, assemble(scene)));
    return list.empty() ? std::string("nothing") : list.front().message;
  };
  EXPECT_EQ(
      warning("method = \"chebyshev\"\nchebyshev_delay = 10"),
      "body 'body' is solved by chebyshev, whose acceleration begins after 10 iterations, and a step has 10: this "
      "is projective-dynamics; make chebyshev_delay smaller than iterations");
  EXPECT_EQ(warning("method = \"chebyshev\"\nchebyshev_delay = 9"), "nothing");
  EXPECT_EQ(warning("method = \"chebyshev\""), "nothing");
  EXPECT_EQ(warning("chebyshev_delay = 10"), "nothing");
}

const std::string spinning_cube = R"(fps = 120
frames = 60
gravity = [0, 0, 0]
[[body]]
name = "cube"
box = { extent = [0.2, 0.2, 0.2], cells = [6, 6, 6] }
density = 1000
material = { model = "neo-hookean", young = 1e5, poisson = 0.3 }
spin_deg = [0, 0, 100]
)";

// Returns what `check` says of a scene, line by line.
std::string said_of(const std::string& scene, const std::vector<std::string>& settings) {
  const Script script = Script::load(SceneSource("scene.toml", scene), test::assets, settings);
  std::string text;
  for (const Problem& problem : said(warnings(script.scene(), assemble(script.scene()))))
    text += problem.message + "\n";
  return text;
}

// Returns the mean angular velocity about the z axis [rad/s].
double spin_of(const World& world) {
  const State& state = world.body(0).state();
  const Eigen::RowVector3d middle = state.x.colwise().mean();
  double turned = 0, reach = 0;
  for (Eigen::Index v = 0; v < state.x.rows(); ++v) {
    const Eigen::RowVector3d arm = state.x.row(v) - middle;
    turned += arm.x() * state.v(v, 1) - arm.y() * state.v(v, 0);
    reach += arm.x() * arm.x() + arm.y() * arm.y();
  }
  return turned / reach;
}

TEST(DampingOfAFreeBody, TakesItsSpinAtTheRateThatIsForetold) {
  const auto spin_after = [](const std::string& damping) {
    World world =
        test::world_of(SceneSource("scene.toml", spinning_cube), {"solver.damping=" + damping, "solver.iterations=30"});
    for (int frame = 0; frame < 60; ++frame) EXPECT_TRUE(world.play(frame));
    return std::pair(spin_of(world), loss_of_spin(world.bodies()[0]));
  };
  const auto [undamped, none] = spin_after("0");
  const auto [damped, rate] = spin_after("1.5e-4");
  EXPECT_EQ(none, 0);
  const double measured = std::log(undamped / damped) / 0.5;  // of half a second [1/s]
  EXPECT_GT(measured, 0.8);
  EXPECT_NEAR(rate, measured, 0.25 * measured);
}

TEST(DampingOfAFreeBody, IsWarnedOfWhereItKeepsTheBodyFromTurning) {
  const std::string slow = "will hardly roll or turn";
  EXPECT_NE(said_of(spinning_cube, {"solver.damping=0.001"}).find(slow), std::string::npos);
  EXPECT_EQ(said_of(spinning_cube, {"solver.damping=1e-6"}), "");
  EXPECT_EQ(said_of(spinning_cube, {"solver.calming=50"}), "");
  EXPECT_EQ(said_of(spinning_cube, {"solver.damping=0.001", "body.cube.meant=[\"turning\"]"}), "");
  const std::string held = "[[body.handles]]\nname = \"end\"\nselect = { box = [[0, 0, 0], [0.1, 1, 1]] }\n";
  EXPECT_EQ(said_of(spinning_cube + held, {"solver.damping=0.001"}), "");
}

TEST(MatrixOfAScene, IsWarnedOfWhereItServesNoBody) {
  const std::string idle = "changes nothing here";
  const std::string cloth =
      "gravity = [0, 0, 0]\n[[body]]\nname = \"sheet\"\nmaterial = \"cotton\"\ncloth = { extent = [1, 1], cells = [4, "
      "4] }\n";
  const auto tells = [&](const std::string& scene, const std::vector<std::string>& settings) {
    return said_of(scene, settings).find(idle) != std::string::npos;
  };
  const std::string turned = "solver.matrix=turned-hessian", tangent = "solver.matrix=tangent";
  EXPECT_TRUE(tells(cloth, {turned}));
  EXPECT_FALSE(tells(cloth, {tangent}));
  EXPECT_FALSE(tells(cloth, {}));
  EXPECT_FALSE(tells(spinning_cube, {turned}));
  EXPECT_FALSE(tells(spinning_cube + cloth.substr(cloth.find("[[body]]")), {turned}));
  EXPECT_TRUE(tells(spinning_cube, {tangent, "solver.integrator=implicit-midpoint"}));
  EXPECT_TRUE(tells(spinning_cube, {tangent, "solver.method=newton"}));
}

}  // namespace method_test
}  // namespace supple
