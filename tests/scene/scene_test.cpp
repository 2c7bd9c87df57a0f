// Tests scene files: what is refused and with which messages, and that the documentation lists what the readers ask
// for.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "base/text.h"
#include "scene/building/assemble.h"
#include "scene/building/warnings.h"
#include "scene/reading/scene_reader.h"
#include "scene/reading/shape_reader.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/scene_text.h"

namespace supple {
namespace scene_test {

using test::problems_of;

const std::string good_body =
    "[[body]]\nshape = \"shapes/squirrel.toml\"\nmaterial = { model = \"polynomial\", mu = 1e4 }\n";

TEST(SceneFile, ReportsEveryProblemAtOnceWithItsPlace) {
  const std::vector<std::string> list = problems_of(R"(frams = 10
fps = 0
gravity = [0, nan, 0]
substeps = 1.5
[solver]
iterations = 0
armijo = -0.3
line_search = "armjo"
[[body]]
shape = "shapes/squirel.toml"
material = { model = "polynomal", mu = 1 }
[[body]]
name = "body"
shape = "shapes/squirrel.toml"
material = { model = "polynomial", mu = -1.0 }
[[body.handles]]
name = "neck"
select = { box = [[0, 0, 0], [1, 1]] }
stiffness = -5
keys = [ { t = 1 }, { t = 0.5 } ]
)");
  const std::vector<std::string> expected = {
      "scene.toml:1:1: unknown key 'frams'; did you mean 'frames'?",
      "scene.toml:2:7: fps = 0: must be a fraction such as \"30000/1001\", or 1 to 100000",
      "scene.toml:3:11: gravity = [0, nan, 0]: must be a list of three numbers, all finite",
      "scene.toml:4:12: substeps = 1.5: must be a whole number, 1 to 1000",
      "scene.toml:6:14: iterations = 0: must be a whole number, 1 to 10000",
      "scene.toml:7:10: armijo = -0.3: must be above 0 to 0.5",
      "scene.toml:8:15: line_search = 'armjo': must be armijo or none; did you mean 'armijo'?",
      "scene.toml:10:9: shape = 'shapes/squirel.toml': no such file (looked for shapes/squirel.toml and " +
          (test::assets / "shapes/squirel.toml").string() + "); did you mean 'shapes/squirrel.toml'?",
      "scene.toml:11:22: model = 'polynomal': must be " + word_list(test::model_names()) +
          "; did you mean 'polynomial'?",
      "scene.toml:13:8: two bodies named 'body'",
      "scene.toml:15:41: mu = -1: must be above 0",
      "scene.toml:18:18: box = [[0, 0, 0], [1, 1]]: must be 2 lists of three numbers, all finite",
      "scene.toml:19:13: stiffness = -5: must be \"hard\" or above 0",
      "scene.toml:20:27: t = 0.5: keys must stand in order of time (the one before is at 1)",
  };
  for (const std::string& message : expected) {
    EXPECT_NE(std::find(list.begin(), list.end(), message), list.end()) << "missing: " << message;
  }
  if (HasFailure()) {
    for (const std::string& message : list) std::cout << message << '\n';
  }
}

TEST(SceneFile, TakesWholeNumbersWithAPoint) {
  const SceneDef scene =
      test::scene_of("frames = 10.0\nsubsteps = 2e0\nfps = 24\n[solver]\niterations = 12.0\n" + good_body);
  EXPECT_EQ(scene.frames, 10);
  EXPECT_EQ(scene.substeps, 2);
  EXPECT_EQ(scene.bodies.front().solver.settings.iterations, 12);
  EXPECT_EQ(problems_of("frames = 10.5\n" + good_body),
            std::vector<std::string>{"scene.toml:1:10: frames = 10.5: must be a whole number, 1 to 1e+06"});
  EXPECT_EQ(problems_of("frames = 1e300\n" + good_body).size(), 1u);
  EXPECT_EQ(problems_of("frames = nan\n" + good_body).size(), 1u);
}

TEST(SceneFile, RefusesNamesThatFilesCannotHave) {
  const auto named = [](const std::string& name) { return problems_of(good_body + "name = \"" + name + "\"\n"); };
  for (const char* name : {"", "a b", "a/b", "a.b"}) {
    EXPECT_EQ(named(name), std::vector<std::string>{"scene.toml:4:8: name = '" + std::string(name) +
                                                    "': must be a word without spaces, dots and slashes"});
  }
  for (const char* name : {"a\\u0000b", "a\\tb"}) {
    EXPECT_EQ(named(name), std::vector<std::string>{"scene.toml:4:8: name: must be a word without control characters, "
                                                    "spaces, dots and slashes"});
  }
  EXPECT_EQ(named(std::string(200, 'a')), std::vector<std::string>{});
  EXPECT_EQ(named(std::string(201, 'a')),
            std::vector<std::string>{
                "scene.toml:4:8: name: has 201 bytes; files are named by it, so at most 200 are allowed"});
}

TEST(SceneFile, AcceptsAGoodSceneWithoutAWord) { EXPECT_EQ(problems_of(good_body), std::vector<std::string>{}); }

TEST(SceneFile, NeedsABodyAndAMaterial) {
  EXPECT_EQ(problems_of("frames = 3"), std::vector<std::string>{"scene.toml:1:1: a scene needs at least one [[body]]"});
  EXPECT_EQ(problems_of("[[body]]\nshape = \"shapes/squirrel.toml\"").size(), 1u);
}

TEST(SceneFile, RefusesWhatIsNotTomlAndWhatIsTooLarge) {
  EXPECT_THROW(Config::parse("frames = = 3", "scene.toml", {}), InputError);
  EXPECT_THROW(Config::parse(std::string(2 << 20, ' '), "scene.toml", {}), InputError);
  EXPECT_THROW(load_scene("/nonexistent.toml", {}, {}), InputError);
}

TEST(SceneFile, SettingsReachEveryValueByItsPath) {
  const auto scene_with = [](const std::vector<std::string>& settings) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.path / "s.toml")
        << good_body
        << "[[body.handles]]\nname = \"neck\"\nselect = { plane = { point = [0, 0.1, 0], normal = [0, -1, 0] } }\n";
    return load_scene(folder.path / "s.toml", test::assets, settings);
  };
  const SceneDef scene = scene_with({"frames=7", "body.body.material.mu=2.5e3", "solver.iterations=3",
                                     "body.body.solver.line_search=none", "body.body.handles.neck.stiffness=12",
                                     "body.body.total_mass=4", "gravity=[0, -1, 0]", "title=a word"});
  EXPECT_EQ(scene.frames, 7);
  EXPECT_EQ(std::get<Polynomial>(scene.bodies[0].substance.material).mu, 2.5e3);
  EXPECT_EQ(scene.bodies[0].solver.settings.iterations, 3);
  EXPECT_EQ(scene.bodies[0].solver.settings.line_search, LineSearch::none);
  EXPECT_EQ(scene.bodies[0].handles[0].stiffness, 12);
  EXPECT_EQ(scene.bodies[0].total_mass, 4);
  EXPECT_EQ(scene.gravity.y(), -1);
  EXPECT_EQ(scene.title, "a word");
  const auto refused = [&](const std::string& setting) -> std::string {
    try {
      (void)scene_with({setting});
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refused("frames"), "--set frames: should read path=value, such as solver.iterations=20");
  EXPECT_EQ(refused("body.head.material.mu=1"),
            "--set body.head.material.mu=1: there is no body named 'head' (there is body)");
  EXPECT_EQ(refused("collider.floor.friction=1"),
            "--set collider.floor.friction=1: there is no collider named 'floor' (there is none)");
  EXPECT_EQ(refused("body.body.shape.ear=1"),
            "--set body.body.shape.ear=1: 'shape' is 'shapes/squirrel.toml' here, not a table with a 'ear' in it; it "
            "can be set as a whole");
  EXPECT_EQ(refused("solver.iteration=5"),
            "--set solver.iteration=5: unknown key 'iteration'; did you mean 'iterations'?");
  EXPECT_EQ(refused("fps=-3"), "--set fps=-3: fps = -3: must be a fraction such as \"30000/1001\", or 1 to 100000");
  EXPECT_EQ(refused("fps=1e400"),
            "--set fps=1e400: fps: '1e400' must be a number or a fraction of two whole numbers, such as "
            "\"30000/1001\", of 1 to 100000");
  EXPECT_EQ(
      refused("look.exposure=1e400"),
      "--set look.exposure=1e400: exposure = '1e400': must be a number, above 0 to 100 (beyond what a number holds)");
}

// Returns why bodies cannot be made from a scene that reads well; empty when they can.
std::string assembly_refused(const std::string& text) {
  const SceneDef scene = test::scene_of(text);
  try {
    (void)assemble(scene);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(SceneFile, EmptySelectionsAndUnknownRegionsAreRefusedTogether) {
  EXPECT_EQ(assembly_refused(R"([[body]]
shape = "shapes/squirrel.toml"
vertices = 1500
material = { model = "polynomial", mu = 1e4 }
[body.regions.tooth]
material = { model = "polynomial", mu = 1e4 }
[[body.handles]]
name = "air"
select = { box = [[2, 2, 2], [3, 3, 3]] }
[[body.handles]]
name = "tail"
select = { region = "tail" }
)"),
            "scene.toml:5:1: body 'body' has no region 'tooth'; did you mean 'teeth'?\n"
            "scene.toml:9:10: handle 'air' of body 'body' selects no vertex; boxes, spheres and planes are relative "
            "to the rest bounding box (0 to 1)\n"
            "scene.toml:12:10: handle 'tail' of body 'body' selects no vertex: there is no region 'tail'");
}

TEST(Scenes, EverySceneThatShipsIsWithoutErrors) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::assets / "scenes")) {
    const SceneDef scene = load_scene(entry.path(), test::assets, {"frames=2"});
    EXPECT_FALSE(scene.title.empty()) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 2);
}

TEST(KeyedMotion, PassesThroughItsKeysAndStandsStillOutside) {
  KeyedMotion motion{
      Vec3(1, 0, 0), Ease::smooth, {{1, Vec3(0, 0, 0), Vec3::Zero()}, {2, Vec3(0, 1, 0), Vec3(0, 90, 0)}}};
  EXPECT_TRUE(motion.at(0).isApprox(Eigen::Isometry3d::Identity()));
  const Eigen::Isometry3d end = motion.at(5);
  EXPECT_LT((end * Vec3(1, 0, 0) - Vec3(1, 1, 0)).norm(), 1e-12);  // the centre moves without turning
  EXPECT_LT((end * Vec3(2, 0, 0) - Vec3(1, 1, -1)).norm(), 1e-12);
  EXPECT_LT((motion.at(1.5) * Vec3(1, 0, 0) - Vec3(1, 0.5, 0)).norm(), 1e-12);
  EXPECT_LT((motion.at(1.01).translation() - motion.at(1).translation()).norm(), 2e-2);  // no jump at the start
}

TEST(KeyedMotion, TurnsAllTheWayRound) {
  const KeyedMotion motion{
      Vec3::Zero(), Ease::linear, {{0, Vec3::Zero(), Vec3::Zero()}, {1, Vec3::Zero(), Vec3(0, 360, 0)}}};
  EXPECT_LT((motion.at(0.5) * Vec3(1, 0, 0) - Vec3(-1, 0, 0)).norm(), 1e-12);
}

TEST(SceneFile, HandlesThatTogetherHoldEverythingAreRefused) {
  EXPECT_EQ(assembly_refused(good_body + R"([[body.handles]]
name = "low"
select = { box = [[0, 0, 0], [1, 0.5, 1]] }
[[body.handles]]
name = "high"
select = { box = [[0, 0.4, 0], [1, 1, 1]] }
)"),
            "scene.toml:9:10: with handle 'high' every vertex of body 'body' is held: nothing is left to move");
}

constexpr const char* material_path = "body[].material.";

// Holds, by the path of a material's key and by what it means there, the models that give it this meaning.
using ModelsByMeaning = std::map<std::string, std::map<std::string, std::set<std::string>>>;

// Returns what a material's key means. models: how many there are; what only some of them have is said with their
// names.
std::string meaning_by_model(const std::map<std::string, std::set<std::string>>& meanings, std::size_t models) {
  std::vector<std::string> parts;
  for (const auto& [meaning, names] : meanings)
    parts.push_back(names.size() == models ? meaning : fmt::format("{}: {}", fmt::join(names, ", "), meaning));
  return fmt::format("{}", fmt::join(parts, "; "));
}

// Makes a scene and a shape that use every key; each model is given once by its own parameters and, where it can be,
// once by Young's modulus.
std::vector<DocumentedKey> all_keys() {
  std::vector<DocumentedKey> keys;
  const std::vector<std::string> models = test::model_names();
  const std::string by_young = ", young = 1, poisson = 0";
  std::vector<std::pair<std::string, std::string>> materials = {
      {"neo-hookean", by_young},
      {"spline", ", preset = \"A\", mu = 1"},
      {"spline", ", preset = \"A\"" + by_young},
  };
  for (const std::string& model : models) materials.emplace_back(model, "");
  ModelsByMeaning meanings;
  for (std::size_t k = 0; k < materials.size(); ++k) {
    const auto [model, parameters] = materials[k];
    const std::string material = fmt::format("{{ model = \"{}\"{} }}", model, parameters);
    Config config = Config::parse(fmt::format(R"([solver]
method = {{ matrix = "system" }}
[solver.contact]
[[body]]
shape = "shapes/squirrel.toml"
box = {{}}
material = {0}
fibre = {{ kappa = 1 }}
start = {{ stretch = [1, 1, 1], turn_deg = [0, 0, 0], twist_deg = 0, random = [1, 1, 1], flatten = "plane" }}
[body.plastic]
[body.creep]
[body.drag]
[body.pressure]
[body.contact]
[body.solver]
[body.regions.NAME]
material = {0}
[[body.handles]]
name = "a"
select = {{ region = "x", box = [[0, 0, 0], [1, 1, 1]], sphere = {{ center = [0, 0, 0], radius = 1 }}, plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }} }}
keys = [{{ t = 0 }}]
attach = {{}}
[[body]]
name = "cloth"
cloth = {{ stretch = 1, seams = [{{}}] }}
[[body]]
name = "preset"
box = {{}}
material = "jelly"
[[body]]
name = "surface"
surface = "surfaces/stairs.obj"
[[collider]]
shape = {{}}
keys = [{{ t = 0 }}]
motion = {{}}
[camera]
keys = [{{ t = 0 }}]
[look]
[field]
[text]
subtitles = [{{ from = 0, to = 1, text = "a line" }}]
[output]
[wind]
[from]
[[scatter]]
[sweep.values]
)",
                                              material),
                                  "keys", test::assets);
    (void)read_scene(config);
    for (const DocumentedKey& key : config.documented()) {
      keys.push_back(key);
      if (key.path.starts_with(material_path)) meanings[key.path][key.meaning].insert(model);
      if (key.path == material_path + std::string("young") && parameters.empty())
        materials.emplace_back(model, by_young);
    }
  }
  for (DocumentedKey& key : keys) {
    if (key.path.starts_with(material_path)) key.meaning = meaning_by_model(meanings.at(key.path), models.size());
  }
  return keys;
}

std::vector<DocumentedKey> shape_keys() {
  Config config = Config::parse(R"([[part]]
sphere = { radius = 1 }
ellipsoid = { radii = [1, 1, 1] }
capsule = { ends = [[0, 0, 0], [1, 0, 0]], radius = 1 }
round_cone = { ends = [[0, 0, 0], [1, 0, 0]], radius = 1, end_radius = 1 }
box = { extent = [1, 1, 1] }
cylinder = { radius = 1, height = 1 }
torus = { radius = 1, tube = 0.5 }
half_space = { normal = [0, 1, 0] }
surface = "surfaces/stairs.obj"
parts = []
[[paint]]
)",
                                "keys", test::assets);
  (void)read_shape(config.root());
  return config.documented();
}

std::string table_of(const std::vector<DocumentedKey>& keys) {
  std::string table = "| key | default | allowed | unit | meaning |\n|---|---|---|---|---|\n";
  std::set<std::string> seen;
  const auto meanings = [&keys](const DocumentedKey& of) {  // several models may use one name for different parameters
    std::vector<std::string> different;
    for (const DocumentedKey& key : keys) {
      const bool same = key.path == of.path && key.type == of.type;
      if (same && std::ranges::find(different, key.meaning) == different.end()) different.push_back(key.meaning);
    }
    return fmt::format("{}", fmt::join(different, "; "));
  };
  for (const DocumentedKey& key : keys) {
    // The materials of regions and the solvers of bodies are documented once, where such keys first occur.
    if (key.path.find("regions.") != std::string::npos && !key.path.ends_with("regions.NAME")) continue;
    if (key.path.starts_with("collider[].shape.")) continue;  // documented as a part in the table of shapes
    if (key.path.starts_with("body[].solver.") || !seen.insert(key.path + key.type).second) continue;
    table +=
        fmt::format("| `{}` | {} | {} | {} | {} |\n", key.path, key.fallback, key.allowed, key.unit, meanings(key));
  }
  return table;
}

TEST(Documentation, ListsEveryKeyOfScenesAndShapesWithItsDefault) {
  const std::string page = test::read_file(test::source_folder / "docs" / "scene-format.md");
  for (const auto& [name, table] :
       {std::pair<std::string, std::string>{"scene", table_of(all_keys())}, {"shape", table_of(shape_keys())}}) {
    if (page.find(table) != std::string::npos) continue;
    const std::filesystem::path candidate = test::build_folder / (name + "-keys.md");
    std::ofstream(candidate) << table;
    ADD_FAILURE() << "docs/scene-format.md does not hold the " << name << " table as the code has it; it is in "
                  << candidate;
  }
}

// Returns the words of a cell such as "a list of ground, plain or shadows"; of any other cell, nothing.
std::vector<std::string> choices_of(const std::string& allowed) {
  static const std::regex list("(a list of )?([A-Za-z0-9-]+(, [A-Za-z0-9-]+)* or [A-Za-z0-9-]+)"), end(", | or ");
  std::smatch match;
  if (!std::regex_match(allowed, match, list)) return {};
  const std::string words = match[2];
  return {std::sregex_token_iterator(words.begin(), words.end(), end, -1), std::sregex_token_iterator()};
}

TEST(Documentation, TheDictionaryOfTheFuzzTargetsHasEveryKeyAndWord) {
  const std::string dictionary = test::read_file(test::source_folder / "tests" / "fuzz" / "toml.dict");
  std::vector<DocumentedKey> keys = all_keys();
  const std::vector<DocumentedKey> of_shapes = shape_keys();
  keys.insert(keys.end(), of_shapes.begin(), of_shapes.end());
  std::set<std::string> missing;
  for (const DocumentedKey& key : keys) {
    std::string path = key.path;
    if (path.ends_with("[]")) path.resize(path.size() - 2);
    const std::string name = path.substr(path.rfind('.') + 1);
    const std::string line = "\"" + name + " = \"";
    if (name != "NAME" && dictionary.find(line) == std::string::npos) missing.insert(line);
    for (const std::string& word : choices_of(key.allowed)) {
      if (dictionary.find("\"" + word + "\"") == std::string::npos) missing.insert("\"" + word + "\"");
    }
  }
  EXPECT_TRUE(missing.empty()) << "tests/fuzz/toml.dict has no\n" << fmt::format("{}", fmt::join(missing, "\n"));
}

}  // namespace scene_test
}  // namespace supple
