// Tests the states that a run leaves: their content, that a step from them has the run's bits, and what is refused.
#include "film/record/state_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "output/files/npy.h"
#include "output/files/whole_file.h"
#include "support/film.h"
#include "support/program.h"
#include "support/stored_problem.h"

namespace supple {
namespace state_file_test {

using test::profile_of;
using test::Result;
using test::run;
using test::StoredProblem;

const std::string bar_scene = R"(frames = 5
title = "A bar that is shaken"
[solver]
iterations = 30
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
position = [0, 0.3, 0]
velocity = [0, 0.2, 0.1]
material = { model = "neo-hookean", mu = 1e4, lambda = 4e4 }
fibre = { kappa = 2e4, direction = [1, 1, 0] }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0, 1, 1]] }
keys = [{ t = 0 }, { t = 0.5, move = [0, 0.1, 0] }]
[[body.handles]]
name = "other"
select = { box = [[1, 0, 0], [1, 0, 1]] }
stiffness = 40
)";
const std::string cloth_and_ball = R"([[body]]
name = "cloth"
cloth = { extent = [0.3, 0.3], cells = [6, 6], stretch = 80, shear = 40, bend = 2 }
turn_deg = [90, 0, 0]
position = [1, 0.31, 0]
[[collider]]
name = "ball"
shape = { sphere = { radius = 0.1 } }
position = [1, 0.2, 0]
thickness = 0.002
friction = 0.25
ease = "linear"
keys = [{ t = 0 }, { t = 1, move = [0, 3, 0] }]
)";

Result render(const std::filesystem::path& folder, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"render", "s.toml", "--no-images", "--quiet", "--force"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run(folder, arguments);
}

std::vector<std::string> hashes_of(const std::filesystem::path& run_folder) {
  std::vector<std::string> hashes;
  const nlohmann::json profile = profile_of(run_folder);
  for (const auto& frame : profile["frames"]) hashes.push_back(frame["state_hash"]);
  return hashes;
}

TEST(States, AreWrittenWhereAskedAndChangeNothing) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << bar_scene << cloth_and_ball;
  const std::filesystem::path out = folder.path / "out" / "s";
  ASSERT_EQ(render(folder.path).status, 0);
  const std::vector<std::string> without = hashes_of(out);
  EXPECT_FALSE(std::filesystem::exists(out / "states"));
  const Result result = render(folder.path, {"--save-state", "0,3", "--save-state", "2"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(hashes_of(out), without);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(out / "states"), {}), 6);
  for (const int frame : {0, 2, 3}) {
    std::vector<std::uint64_t> hashes;
    for (const char* body : {"bar", "cloth"}) {
      const StoredState stored = read_state(out / "states" / fmt::format("{}-{:06}", body, frame));
      EXPECT_EQ(stored.body, body);
      EXPECT_EQ(stored.frame, frame);
      EXPECT_NEAR(stored.time, frame / 30.0, 1e-12);
      const auto text = nlohmann::json::parse(test::read_file(stored.folder / "state.json"))["state_hash"];
      hashes.push_back(std::stoull(text.get<std::string>(), nullptr, 16));
    }
    // The profile has XXH64 of the bodies' hashes in the row of the frame before.
    if (frame > 0) {
      EXPECT_EQ(hash_text_form(hash_bytes(hashes.data(), 16)), without[frame - 1]);
    }
  }
  ASSERT_EQ(render(folder.path).status, 0);
  EXPECT_FALSE(std::filesystem::exists(out / "states")) << "a new run takes over the folder";
}

TEST(States, SayWhatTheSceneSaid) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << "substeps = 2\n" << bar_scene << cloth_and_ball;
  ASSERT_EQ(render(folder.path, {"--save-state", "3"}).status, 0);
  const std::filesystem::path states = folder.path / "out" / "s" / "states";
  const StoredProblem bar(states / "bar-000003"), cloth(states / "cloth-000003");
  EXPECT_EQ(bar.json["version"], 2);
  EXPECT_EQ(bar.json["scene"], "s");
  EXPECT_EQ(bar.json["title"], "A bar that is shaken");
  EXPECT_EQ(bar.json["step"], 6);
  EXPECT_EQ(bar.json["time_step"], 1.0 / 60);
  EXPECT_EQ(bar.json["vertices"], 81);
  EXPECT_EQ(bar.json["handled"], 12);
  EXPECT_EQ(bar.json["solver"]["iterations"], 30);
  EXPECT_EQ(bar.json["regions"][0]["material"]["model"], "neo-hookean");
  EXPECT_EQ(bar.json["regions"][0]["fibre"]["kappa"], 2e4);
  EXPECT_EQ(cloth.json["tets"], 0);
  EXPECT_EQ(cloth.json["regions"].size(), 0u);
  EXPECT_EQ(read_npy_ints(states / "cloth-000003" / "springs.npy").shape.rows, cloth.json["springs"]);
  const nlohmann::json& ball = bar.json["colliders"][0];
  EXPECT_EQ(ball["name"], "ball");
  EXPECT_EQ(ball["thickness"], 0.002);
  EXPECT_EQ(ball["friction"], 0.25);
  for (const auto& [pose, steps] : {std::pair("start", 6), std::pair("end", 7)}) {
    Eigen::Matrix4d expected = Eigen::Matrix4d::Identity();
    expected.col(3) << 1, 0.2 + 3.0 * steps / 60, 0, 1;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) EXPECT_NEAR(ball[pose][i][j].get<double>(), expected(i, j), 1e-12) << pose;
    }
  }
  // This is the moving handle's target at the end of the first substep of the frame, smoothly eased.
  const NpyArray<double> targets = read_npy_doubles(states / "bar-000003" / "targets.npy");
  const NpyArray<std::int32_t> handled = read_npy_ints(states / "bar-000003" / "handled.npy");
  const double s = 7.0 / 60 / 0.5;
  EXPECT_NEAR(targets.values[1], bar.rest(handled.values[0], 1) + 0.1 * s * s * (3 - 2 * s), 1e-12);
}

TEST(States, GiveTheRunsBitsWhenTheStepIsMadeAgain) {
  const test::TemporaryFolder folder;
  for (const char* settings : {"substeps = 2\n", ""}) {
    std::ofstream(folder.path / "s.toml") << settings << bar_scene << cloth_and_ball;
    ASSERT_EQ(render(folder.path, {"--save-state", "3,4"}).status, 0);
    const std::filesystem::path states = folder.path / "out" / "s" / "states";
    const auto profile = profile_of(folder.path / "out" / "s");
    EXPECT_GT(profile["frames"][3]["bodies"][1]["contacts"], 0);
    const test::Film film(folder.path / "s.toml", {});
    for (std::size_t b = 0; b < film.bodies.size(); ++b) {
      const std::string& name = film.bodies[b].def.name;
      const Model& model = film.models[b];
      const StoredState stored = read_state(states / (name + "-000003"));
      State state = state_for(model, stored);
      StepInputs inputs{film.scene.gravity, {}, {}, film.bodies[b].def.solver.settings, &film.set.colliders};
      OpenWorkspace w;
      for (int substep = 0; substep < film.scene.substeps; ++substep) {
        const double done = 3.0 * film.scene.substeps + substep, h = film.scene.time_step();
        handle_targets(model, film.bodies[b], (done + 1) * h, inputs.targets);
        collider_motions(film.set, {done * h, (done + 1) * h}, inputs.collider_motions);
        if (substep == 0) {
          const NpyArray<double> y = read_npy_doubles(stored.folder / "y.npy");
          w.prepare(model, inputs.solver);
          begin_step(model, inputs, state, w);
          EXPECT_EQ(in_input_order(model, w.y), Eigen::Map<const Positions>(y.values.data(), y.shape.rows, 3));
        }
        ASSERT_FALSE(step(model, inputs, state, w).failed);
      }
      const StoredState after = read_state(states / (name + "-000004"));
      EXPECT_EQ(in_input_order(model, state.x), after.q) << name;
      EXPECT_EQ(in_input_order(model, state.v), after.v) << name;
      EXPECT_EQ(state.time, after.time) << name;
    }
  }
}

// g, computed from the files alone at the next frame's state, must be the value that the solver reports.
TEST(States, HoldTheObjectiveThatTheProfileReports) {
  const test::TemporaryFolder folder;
  for (const char* more : {"", "damping = 0.01\n", "integrator = \"implicit-midpoint\"\n"}) {
    const std::string heading = "[solver]\n";
    std::string scene = bar_scene;
    scene.insert(scene.find(heading) + heading.size(), more);
    std::ofstream(folder.path / "s.toml") << scene;
    ASSERT_EQ(render(folder.path, {"--save-state", "2,3"}).status, 0) << scene;
    const std::filesystem::path out = folder.path / "out" / "s";
    const StoredProblem before(out / "states" / "bar-000002"), after(out / "states" / "bar-000003");
    const double reported = profile_of(out)["frames"][2]["bodies"][0]["objective_end"];
    const StoredProblem::Value value = before.at(after.q);
    EXPECT_NEAR(value.objective, reported, 1e-10 * value.size);
    EXPECT_GT(reported, 0);
    EXPECT_LT(value.objective, before.at(before.q).objective);
  }
}

TEST(States, BeyondTheFilmAreRefused) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << bar_scene;
  Result result = render(folder.path, {"--save-state", "2,5"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err, "--save-state 5: the film has 5 frames, 0 to 4\n");
  result = render(folder.path, {"--save-state", "1", "--frames", "1"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err, "--save-state 1: the film has one frame, 0\n");
  EXPECT_EQ(render(folder.path, {"--save-state", "-1"}).status, 2);
  EXPECT_EQ(render(folder.path, {"--save-state", "two"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "out"));
}

// Writes a bar's folder without a film.
struct Written {
  test::TemporaryFolder folder;
  Model model;

  explicit Written(const BodyDescription& body = test::bar(NeoHookean{1e4, 3e4}, test::Held::hard_end))
      : model(build_model(body)) {
    State state = rest_state(model);
    state.x = test::shaken(model.rest, 0.01, 1);
    write_state(folder.path, {"scene", "title", 7, 7}, problem_of(body, model, test::still_inputs(model), state));
  }
  std::filesystem::path json() const { return folder.path / "state.json"; }
  void edit(const std::string& from, const std::string& to) const {
    std::string text = test::read_file(json());
    ASSERT_NE(text.find(from), std::string::npos) << from;
    write_whole_file(json(), text.replace(text.find(from), from.size(), to));
  }
  // Returns the message without the folder's name.
  std::string complaint() const {
    try {
      (void)state_for(model, read_state(folder.path));
    } catch (const InputError& error) {
      const std::string text = error.what(), name = folder.path.string();
      EXPECT_EQ(error.problems().size(), 1u);
      EXPECT_TRUE(text.starts_with(name)) << text;
      return text.substr(name.size());
    }
    return "";
  }
};

TEST(States, ThatWereChangedOrAreOfAnotherVersionAreRefused) {
  {
    const Written written;
    EXPECT_EQ(written.complaint(), "");
    const std::string hash = nlohmann::json::parse(test::read_file(written.json()))["state_hash"];
    std::string bytes = test::read_file(written.folder.path / "v.npy");
    bytes.back() ^= 1;
    write_whole_file(written.folder.path / "v.npy", bytes);
    EXPECT_TRUE(written.complaint().starts_with("/state.json: state_hash is " + hash + ", but q.npy and v.npy have "));
  }
  {
    const Written written;
    written.edit("\"version\": 2", "\"version\": 1");
    EXPECT_EQ(written.complaint(), "/state.json: is of version 1; version 2 is the one that this program reads");
    written.edit("\"version\": 1", "\"version\": 1.5");
    EXPECT_EQ(written.complaint(), "/state.json: 'version' cannot be 1.5");
    written.edit("\"version\": 1.5", "\"versions\": 1");
    EXPECT_EQ(written.complaint(), "/state.json: 'version' is missing");
  }
  {
    const Written written;
    written.edit("\"vertices\": 20", "\"vertices\": 21");
    EXPECT_EQ(written.complaint(), "/q.npy: is 20 x 3 where state.json has 21 vertices: 21 x 3 belongs there");
  }
  const Written written;
  write_whole_file(written.json(), test::read_file(written.json()).substr(0, 100));
  const std::string not_a_state = "/state.json: is not the description of a state (\"format\": \"supple-state\")";
  EXPECT_EQ(written.complaint(), not_a_state);
  write_whole_file(written.json(), std::string_view("[1]"));
  EXPECT_EQ(written.complaint(), not_a_state);
  std::filesystem::remove(written.json());
  EXPECT_EQ(written.complaint(), "/state.json: no such file: this is not the folder of a state");
}

TEST(States, OfABodyOfAnotherSizeAreRefused) {
  const Written written;
  const Model finer =
      build_model(test::bar(NeoHookean{1e4, 3e4}, test::Held::hard_end, Precision::double_precision, 2));
  try {
    (void)state_for(finer, read_state(written.folder.path));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), written.folder.path.string() + ": has 20 vertices; body 'bar' has 81");
  }
}

// Adds every key and file that a state can have.
void add_keys(const nlohmann::json& json, const std::string& path, std::set<std::string>& keys) {
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) {
      keys.insert(path + key);
      // The parameters of materials are those of scene files.
      if (key != "material") add_keys(value, path + key + ".", keys);
    }
  } else if (json.is_array() && !json.empty() && json[0].is_object()) {
    std::string element = path;
    element.insert(element.size() - 1, "[]");
    add_keys(json[0], element, keys);
  }
}

TEST(Documentation, NamesEveryKeyAndFileOfAState) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << "[solver]\nintegrator = \"implicit-midpoint\"\n"
                                        << bar_scene.substr(bar_scene.find("[[body]]")) << cloth_and_ball;
  ASSERT_EQ(render(folder.path, {"--frames", "1", "--save-state", "0"}).status, 0);
  std::set<std::string> names;
  for (const char* body : {"bar", "cloth"}) {
    const std::filesystem::path state = folder.path / "out" / "s" / "states" / fmt::format("{}-000000", body);
    for (const auto& entry : std::filesystem::directory_iterator(state)) names.insert(entry.path().filename());
    add_keys(nlohmann::json::parse(test::read_file(state / "state.json")), "", names);
  }
  EXPECT_GT(names.size(), 45u);
  const std::string page = test::read_file(test::source_folder / "docs" / "states.md");
  for (const std::string& name : names) EXPECT_NE(page.find("`" + name + "`"), std::string::npos) << name;
}

}  // namespace state_file_test
}  // namespace supple
