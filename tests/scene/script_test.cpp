// Tests replays: the scene of each frame, and what is refused.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "scene/building/warnings.h"
#include "scene/replay/script.h"
#include "support/bodies.h"

namespace supple {
namespace script_test {

class Replay : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path / "bar.toml") << R"(frames = 60
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
material = { model = "neo-hookean", mu = 10000, lambda = 20000 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
[[collider]]
name = "ball"
shape = { sphere = { radius = 0.1 } }
position = [0, -1, 0]
)";
  }
  Script script(const std::string& changes, const std::vector<std::string>& settings = {}) {
    std::ofstream(folder_.path / "r.toml") << "scene = \"bar.toml\"\n" << changes;
    return Script::load(folder_.path / "r.toml", test::assets, settings);
  }
  std::string refused(const std::string& changes) {
    try {
      (void)script(changes);
    } catch (const InputError& error) {
      const std::string path = (folder_.path / "").string();
      std::string text = error.what();
      for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path)) text.erase(at, path.size());
      return text;
    }
    return "accepted";
  }
  static double mu_of(const SceneDef& scene) { return std::get<NeoHookean>(scene.bodies[0].substance.material).mu; }

  test::TemporaryFolder folder_;
};

TEST_F(Replay, WithoutChangesItIsItsScene) {
  const Script plain = script("");
  EXPECT_TRUE(plain.is_replay());
  EXPECT_EQ(plain.scene().name, "r");
  EXPECT_EQ(mu_of(plain.scene()), 10000);
  for (int frame = 0; frame < 60; ++frame) EXPECT_TRUE(plain.at_work(frame).empty());
  EXPECT_FALSE(Script::load(folder_.path / "bar.toml", test::assets, {}).is_replay());
}

TEST_F(Replay, JumpsTakeEffectInTheirFrame) {
  const Script jump = script("[[change]]\nt = 1\npath = 'body.bar.material.mu'\nvalue = 5e4\n");
  EXPECT_EQ(mu_of(jump.scene_at(29)), 10000);
  EXPECT_EQ(mu_of(jump.scene_at(30)), 50000);
  for (int frame = 0; frame < 60; ++frame) EXPECT_EQ(jump.at_work(frame).size(), frame == 30 ? 1u : 0u) << frame;
  const Script by_frame = script("[[change]]\nframe = 30\npath = 'body.bar.material.mu'\nvalue = 5e4\n");
  EXPECT_EQ(mu_of(by_frame.scene_at(29)), 10000);
  EXPECT_EQ(mu_of(by_frame.scene_at(30)), 50000);
  const Script at_once = script("[[change]]\nt = 0\npath = 'body.bar.material.mu'\nvalue = 5e4\n");
  EXPECT_EQ(mu_of(at_once.scene()), 50000);
  EXPECT_TRUE(at_once.at_work(0).empty());
}

TEST_F(Replay, RampsLeadThroughWhatLiesBetween) {
  const Script linear = script(
      "[[change]]\nt = 1\nover = 0.5\nease = 'linear'\npath = 'body.bar.material.mu'\nvalue = 40000\n"
      "[[change]]\nt = 1\nframes = 15\nease = 'linear'\nby = 'ratio'\npath = 'body.bar.material.lambda'\nvalue = "
      "80000\n");
  EXPECT_EQ(mu_of(linear.scene_at(29)), 10000);
  EXPECT_NEAR(mu_of(linear.scene_at(30)), 12000, 1e-6);
  EXPECT_NEAR(mu_of(linear.scene_at(36)), 24000, 1e-6);
  EXPECT_EQ(mu_of(linear.scene_at(44)), 40000);
  EXPECT_EQ(mu_of(linear.scene_at(59)), 40000);
  const auto lambda = [&](int frame) {
    return std::get<NeoHookean>(linear.scene_at(frame).bodies[0].substance.material).lambda;
  };
  EXPECT_NEAR(lambda(36) / lambda(35), lambda(40) / lambda(39), 1e-9);
  EXPECT_EQ(lambda(44), 80000);
  EXPECT_EQ(linear.at_work(29).size() + linear.at_work(45).size(), 0u);
  EXPECT_EQ(linear.at_work(30).size() + linear.at_work(44).size(), 4u);
  const Script smooth = script("[[change]]\nt = 1\nover = 0.4\npath = 'gravity'\nvalue = [0, -1.81, 8]\n");
  EXPECT_NEAR(smooth.scene_at(32).gravity.y(), -9.81 + 8 * (0.25 * 0.25 * 2.5),
              1e-9);  // 3 of 12 frames; y is the default's
  EXPECT_NEAR(smooth.scene_at(35).gravity.z(), 4, 1e-9);
}

TEST_F(Replay, WholeNumbersStayWholeAndListsGoNumberByNumber) {
  const Script whole = script(
      "[[change]]\nt = 1\nover = 1\npath = 'solver.iterations'\nvalue = 31\n"
      "[[change]]\nt = 1\npath = 'body.bar.material'\nvalue = { model = 'spline', a = [[0.5, -100], [1, 0], [2, 10]] "
      "}\n"
      "[[change]]\nt = 1.5\nover = 0.4\nease = 'linear'\npath = 'body.bar.material.a'\nvalue = [[0.5, -300], [1, 0], "
      "[2, 50]]\n");
  EXPECT_EQ(whole.scene_at(44).bodies[0].solver.settings.iterations, 21);
  EXPECT_EQ(whole.scene_at(59).bodies[0].solver.settings.iterations, 31);
  const Spline spline = std::get<Spline>(whole.scene_at(50).bodies[0].substance.material);
  EXPECT_NEAR(spline.a.points()[0].value, -200, 1e-9);
  EXPECT_NEAR(spline.a.points()[2].value, 30, 1e-9);
}

TEST_F(Replay, ColorsInHexadecimalDigitsGoChannelByChannel) {
  const std::string half = "[[change]]\nt = 1\nover = 1\nease = 'linear'\npath = 'body.bar.color'\n";
  for (const char* ends : {"from = '#003366'\nvalue = '#ff3300'\n", "from = [0, 0.2, 0.4]\nvalue = '#ff3300'\n",
                           "from = '#003366'\nvalue = [1, 0.2, 0]\n"}) {
    const Vec3 color = script(half + ends).scene_at(44).bodies[0].color.value();
    EXPECT_TRUE(color.isApprox(Vec3(0.5, 0.2, 0.2), 1e-9)) << ends << color.transpose();
  }
  EXPECT_EQ(refused(half + "from = '#00336'\nvalue = '#ff3300'\n"),
            "r.toml:8:9: a ramp leads through numbers, or lists of them of one form; not from '#00336' to '#ff3300'. "
            "Words and tables jump: leave out 'over' or 'frames'");
  EXPECT_EQ(refused(half + "from = '#003366'\nvalue = [1, 0.2]\n"),
            "r.toml:8:9: a ramp leads through numbers, or lists of them of one form; not from '#003366' to [1, 0.2]");
}

TEST_F(Replay, LaterChangesBeginWhereEarlierOnesAre) {
  const Script chain = script(
      "[[change]]\nt = 1.5\nover = 0.3\nease = 'linear'\npath = 'body.bar.material.mu'\nvalue = 10000\n"
      "[[change]]\nt = 1\nover = 1\nease = 'linear'\npath = 'body.bar.material.mu'\nvalue = 20000\n");
  EXPECT_NEAR(mu_of(chain.scene_at(44)), 15000, 1e-3);
  EXPECT_NEAR(mu_of(chain.scene_at(47)), 15000 - 5000.0 * 3 / 9, 1e-3);
  EXPECT_EQ(mu_of(chain.scene_at(59)), 10000);
}

TEST_F(Replay, StartsFromWhatItSetsAndGrabs) {
  const Script set = script(
      "frames = 20\ntitle = 'other'\n[set]\n'body.bar.material.mu' = 7\n"
      "[[grab]]\nbody = 'bar'\nname = 'fingers'\nselect = { box = [[0.9, 0, 0], [1, 1, 1]] }\nstiffness = 5\nfrom = "
      "0.2\nuntil = 0.4\n",
      {"body.bar.material.lambda=8"});
  EXPECT_EQ(set.scene().frames, 20);
  EXPECT_EQ(set.scene().title, "other");
  EXPECT_EQ(mu_of(set.scene()), 7);
  ASSERT_EQ(set.scene().bodies[0].handles.size(), 2u);
  const HandleDef& fingers = set.scene().bodies[0].handles[1];
  EXPECT_TRUE(fingers.grabs);
  EXPECT_FALSE(fingers.holds_at(5 / 30.0));
  EXPECT_TRUE(fingers.holds_at(6 / 30.0));
  EXPECT_TRUE(fingers.holds_at(11 / 30.0));
  EXPECT_FALSE(fingers.holds_at(12 / 30.0));
}

TEST_F(Replay, CollidersAndCameraMove) {
  const Script moved = script(
      "[[change]]\nt = 0.5\nover = 0.5\npath = 'collider.ball.shape.sphere.radius'\nvalue = 0.3\n"
      "[[change]]\nt = 0.5\npath = 'camera.fov_deg'\nvalue = 50\n");
  EXPECT_NEAR(moved.scene_at(29).colliders[0].shape.distance(Vec3(1, 0, 0)), 0.7, 1e-9);
  EXPECT_EQ(moved.scene_at(15).camera.fov_deg, 50);
  EXPECT_TRUE(moved.at_work(20)[0]->cost.surface);
}

TEST_F(Replay, RefusesWithPlaceAndReason) {
  EXPECT_EQ(
      refused("[[change]]\nt = 1\npath = 'body.bar.box.cells'\nvalue = [1, 2, 3]\n"),
      "r.toml:4:8: 'body.bar.box.cells' cannot change while the film runs; `supple info --live SCENE` lists what can");
  EXPECT_EQ(refused("[[change]]\nt = 1\npath = 'body.bar.material.mu'\nvalue = -4\n"),
            "r.toml:5:9: mu = -4: must be above 0 (first in frame 30)");
  EXPECT_EQ(refused("[[change]]\nt = 1\npath = 'body.rod.material.mu'\nvalue = 4\n"),
            "r.toml:5:9: there is no body named 'rod' (there is bar)");
  EXPECT_EQ(refused("[[change]]\nt = 1\npath = 'body.bar.material.muu'\nvalue = 4\n"),
            "r.toml:5:9: unknown key 'muu'; did you mean 'mu'? (first in frame 30)");
  EXPECT_EQ(refused("[[change]]\npath = 'gravity'\nvalue = [0, 0, 0]\n"),
            "r.toml:2:1: when? 't' [s] or 'frame' is missing");
  EXPECT_EQ(refused("[[change]]\nt = 1\nover = 1\npath = 'gravity'\nvalue = 3\n"),
            "r.toml:6:9: a ramp leads through numbers, or lists of them of one form; not from [0, -9.81, 0] to 3");
  EXPECT_EQ(refused("[[change]]\nt = 1\nover = 1\nby = 'ratio'\npath = 'gravity'\nvalue = [1, 2, 3]\n"),
            "r.toml:7:9: by = \"ratio\": only between positive numbers");
  EXPECT_EQ(refused("[[chnage]]\nt = 1\n"), "r.toml:2:3: unknown key 'chnage'; did you mean 'change'?");
  EXPECT_EQ(refused("[[grab]]\nbody = 'bar'\nname = 'f'\nselect = { box = [[0.9, 0, 0], [1, 1, 1]] }\nfrom = 1\n"),
            "r.toml:2:1: a handle that grabs or lets go needs a number as its stiffness [N/m]");
  // A value that is wrong in the middle of a ramp is reported at its own line.
  EXPECT_EQ(refused("[[change]]\nt = 0.5\nover = 1\npath = 'camera.fov_deg'\nvalue = 500\n").substr(0, 10),
            "r.toml:6:9");
}

TEST_F(Replay, ListsAllWrongChangesAtOnce) {
  std::istringstream list(
      refused("[set]\n'body.rod.density' = 3\n"
              "[[change]]\nt = 1\npath = 'body.rod.material.mu'\nvalue = 4\n"
              "[[change]]\nt = 0.5\npath = 'body.bar.box.cells'\nvalue = [1, 2, 3]\n"
              "[[change]]\nt = 0\npath = 'camera.fov_deg'\nvalue = 500\n"
              "[[change]]\nt = 1.5\nover = 0.1\npath = 'gravity'\nvalue = 3\n"
              "[[change]]\nt = 1\nover = 0.2\npath = 'body.bar.material.mu'\nvalue = -3e4\n"
              "[[change]]\nt = 1\npath = 'solver.iterations'\nvalue = 0\nvalu = 0\n"));
  for (const char* expected : {
           "r.toml:3:22: there is no body named 'rod' (there is bar)",
           "r.toml:7:9: there is no body named 'rod' (there is bar)",
           "r.toml:10:8: 'body.bar.box.cells' cannot change while the film runs",
           "r.toml:15:9: fov_deg = 500: must be 1 to 150",
           "r.toml:20:9: a ramp leads through numbers, or lists of them of one form; not from [0, -9.81, 0] to 3",
           "r.toml:25:9: mu = -",
           "r.toml:29:9: iterations = 0: must be ",
           "r.toml:30:1: unknown key 'valu'; did you mean 'value'?",
       }) {
    std::string line;
    std::getline(list, line);
    EXPECT_TRUE(line.starts_with(expected)) << line;
  }
  EXPECT_EQ(list.peek(), std::char_traits<char>::eof()) << list.str();
}

TEST_F(Replay, TellsAtAChangeWhatItMakesWrongElsewhere) {
  EXPECT_EQ(refused("[[change]]\nt = 1\npath = 'body.bar.material.model'\nvalue = 'as-rigid-as-possible'\n"),
            "r.toml:5:9: body.bar.material.model = 'as-rigid-as-possible' does not go with what stands beside it: "
            "unknown key "
            "'lambda'; allowed here: model, mu, poisson or young (bar.toml:5:49). Change all of it at once: path = "
            "\"body.bar.material\", value = { ... } (first in frame 30)");
  for (const char* over : {"", "over = 1\n"}) {
    const std::string text =
        refused(std::string("[[change]]\nt = 1\npath = 'body.bar.material.young'\nvalue = 5e4\n") + over);
    EXPECT_TRUE(
        text.starts_with("r.toml:5:9: body.bar.material.young = 50000 does not go with what stands beside it: "
                         "'poisson' is missing"))
        << text;
    EXPECT_NE(text.find("; mu: not together with young and poisson, which say the same (bar.toml:5:42); "),
              std::string::npos)
        << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

TEST_F(Replay, FilesAreBesideTheFileThatNamesThem) {
  std::filesystem::create_directory(folder_.path / "shapes");
  std::filesystem::create_directory(folder_.path / "replays");
  std::ofstream(folder_.path / "shapes" / "scene.toml")
      << "frames = 10\n[[body]]\nbox = { extent = [1, 1, 1], cells = [1, 1, 1] }\nmaterial = \"rubber\"\n"
         "[[collider]]\nname = \"c\"\nshape = { sphere = { radius = 1 } }\n";
  std::ofstream(folder_.path / "replays" / "cube.toml") << "[[part]]\nbox = { extent = [1, 1, 1] }\n";
  const std::filesystem::path replay = folder_.path / "replays" / "r.toml";
  std::ofstream(replay) << "scene = \"../shapes/scene.toml\"\n[[change]]\nframe = 2\npath = \"collider.c.shape\"\n"
                           "value = \"cube.toml\"\n";
  EXPECT_NO_THROW((void)Script::load(replay, test::assets, {}));
}

TEST_F(Replay, SaysWhatToWriteInstead) {
  const std::string rubber = "[set]\n'body.bar.material' = 'rubber'\n", change = "[[change]]\nt = 1\n";
  for (const char* over : {"", "over = 1\n"}) {
    EXPECT_EQ(
        refused(rubber + change + "path = 'body.bar.material.young'\nvalue = 5e4\n" + over),
        "r.toml:7:9: body.bar.material is the preset 'rubber' here, and a preset has no 'young'; write in its "
        "place what it stands for: material = { model = \"neo-hookean\", young = 1e+06, poisson = 0.45 }, density = "
        "1100");
  }
  EXPECT_EQ(refused(rubber + change + "over = 1\npath = 'body.bar.material'\nvalue = 'jelly'\n"),
            "r.toml:8:9: a ramp leads through numbers, or lists of them of one form; not from 'rubber' to 'jelly'. "
            "Words and tables jump: leave out 'over' or 'frames'");
  EXPECT_EQ(refused(change + "path = 'body.bar.material.mu'\nvalue = '5e4'\n"),
            "r.toml:5:9: mu = '5e4': must be a number, above 0 (in quotes it is a word) (first in frame 30)");
  EXPECT_EQ(refused(change + "path = 'body.bar.material.mu'\nvalue = 'soft'\n"),
            "r.toml:5:9: mu = 'soft': must be a number, above 0 (first in frame 30)");
  EXPECT_EQ(refused(change + "path = 'body.bar.handles.fingers.stiffness'\nvalue = 5\n"),
            "r.toml:5:9: there is no handle named 'fingers' (there is end)");
}

TEST_F(Replay, RefusesSlipsOfThePen) {
  EXPECT_EQ(refused("[[change]]\nt = 1\npath = ''\nvalue = 4\n"),
            "r.toml:4:8: '' cannot change while the film runs; `supple info --live SCENE` lists what can");
  EXPECT_EQ(refused("[[change]]\nt = 1\nover = 1\npath = 'body.bar.material.muu'\nvalue = 4\n"),
            "r.toml:6:9: unknown key 'muu'; did you mean 'mu'?");
  EXPECT_EQ(refused("[[change]]\nframe = 1.5\npath = 'gravity'\nvalue = [0, 0, 0]\n").substr(0, 23),
            "r.toml:3:9: frame = 1.5");
  EXPECT_EQ(refused("[[grab]]\nbody = 'rod'\nname = 'f'\n"), "r.toml:3:8: there is no body named 'rod' (there is bar)");
  std::ofstream(folder_.path / "n.toml") << "[[change]]\nt = 1\npath = 'gravity'\nvalue = [0, 0, 0]\n";
  EXPECT_THROW(
      {
        try {
          (void)Script::load(folder_.path / "n.toml", test::assets, {});
        } catch (const InputError& error) {
          EXPECT_NE(std::string(error.what()).find("'scene' is missing"), std::string::npos) << error.what();
          throw;
        }
      },
      InputError);
}

TEST_F(Replay, WarnsOfGrabsThatJump) {
  const auto warned = [this](const std::string& keys) {
    const Script grab = script(
        "[[grab]]\nbody = 'bar'\nname = 'f'\nselect = { box = [[0.9, 0, 0], [1, 1, 1]] }\nstiffness = 5\nfrom = 0.5\n"
        "keys = " +
        keys + "\n");
    std::string all;
    for (const Problem& warning : said(warnings(grab.scene(), assemble(grab.scene())))) all += warning.text() + "\n";
    return all.find("handle 'f' of body 'bar' has moved by its keys already when it grabs") != std::string::npos;
  };
  EXPECT_TRUE(warned("[{ t = 0.1 }, { t = 0.4, move = [0, 0.1, 0] }]"));
  EXPECT_TRUE(warned("[{ t = 0.4 }, { t = 0.6, turn_deg = [0, 40, 0] }]"));
  EXPECT_FALSE(warned("[{ t = 0.5 }, { t = 0.6, move = [0, 0.1, 0] }]"));
  EXPECT_FALSE(warned("[{ t = 0 }, { t = 0.5 }, { t = 0.6, move = [0, 0.1, 0] }]"));
}

TEST_F(Replay, WarnsOfWhatNoFrameSees) {
  const Script late = script(
      "[[change]]\nt = 2\npath = 'gravity'\nvalue = [0, 0, 0]\n"
      "[[change]]\nt = 1\nover = 2\npath = 'body.bar.material.mu'\nvalue = 5\n"
      "[[grab]]\nbody = 'bar'\nname = 'f'\nselect = { box = [[0.9, 0, 0], [1, 1, 1]] }\nstiffness = 5\nfrom = "
      "0.501\nuntil = 0.502\n");
  std::string all;
  for (const Problem& warning : late.warnings()) all += warning.text() + "\n";
  EXPECT_NE(all.find("gravity would change at 2 s, when the film is over (2 s)"), std::string::npos) << all;
  EXPECT_NE(all.find("before body.bar.material.mu has changed all the way"), std::string::npos) << all;
  EXPECT_NE(all.find("handle 'f' of body 'bar' never holds"), std::string::npos) << all;
  EXPECT_EQ(late.warnings().size(), 3u) << all;
  EXPECT_TRUE(script("[[change]]\nt = 1\nover = 1\npath = 'body.bar.material.mu'\nvalue = 5\n").warnings().empty());
}

TEST_F(Replay, WarnsOfRampsThatAnotherChangeBreaksOff) {
  const auto warned = [this](const std::string& changes) {
    std::string all;
    const std::string path = (folder_.path / "r.toml").string();
    for (const Problem& warning : script(changes).warnings()) all += warning.text().substr(path.size()) + "\n";
    return all;
  };
  const std::string ramp = "[[change]]\nt = 0.5\nover = 1\npath = 'body.bar.material.mu'\nvalue = 2e4\n";
  const std::string says =
      " s on this change sets body.bar.material.mu; the ramp of line 6 (0.5 to 1.5 s) ends there, "
      "unfinished\n";
  EXPECT_EQ(warned(ramp + "[[change]]\nt = 1\nover = 0.2\npath = 'body.bar.material.mu'\nvalue = 3e4\n"),
            ":11:9: from 1" + says);
  EXPECT_EQ(warned(ramp + "[[change]]\nt = 1.25\npath = 'body.bar.material.mu'\nvalue = 3e4\n"
                          "[[change]]\nt = 1.4\npath = 'body.bar.material.mu'\nvalue = 4e4\n"),
            ":10:9: from 1.25" + says);
  EXPECT_EQ(warned(ramp + "[[change]]\nt = 1\npath = 'body.bar.material'\nvalue = 'jelly'\n"), ":10:9: from 1" + says);
  // One change begins after the other has ended, and one concerns another value.
  EXPECT_EQ(warned(ramp + "[[change]]\nt = 1.5\npath = 'body.bar.material.mu'\nvalue = 3e4\n"
                          "[[change]]\nt = 1\npath = 'body.bar.material.lambda'\nvalue = 3e4\n"),
            "");
  // The warning describes this case: the value jumps at the change, and the ramp does not return.
  const Script broken = script(ramp + "[[change]]\nt = 1\npath = 'body.bar.material.mu'\nvalue = 3e4\n");
  EXPECT_LT(mu_of(broken.scene_at(29)), 2e4);
  EXPECT_EQ(mu_of(broken.scene_at(30)), 3e4);
  EXPECT_EQ(mu_of(broken.scene_at(50)), 3e4);
}

// The scene has no table [look], and its bar no solver of its own.
TEST_F(Replay, RampsBeginAtDefaults) {
  const Script lighter = script("[[change]]\nt = 0\nover = 1\nease = 'linear'\npath = 'look.exposure'\nvalue = 3\n");
  EXPECT_NEAR(lighter.scene_at(14).look.exposure, 2, 1e-9);
  const Script longer = script(
      "[[change]]\nt = 0\nover = 1\nease = 'linear'\npath = 'body.bar.solver.iterations'\n"
      "value = 30\n");
  EXPECT_EQ(longer.scene_at(14).bodies[0].solver.settings.iterations, 20);
  const std::string listed = "look.exposure";
  EXPECT_TRUE(std::ranges::any_of(script("").live(), [&](const LiveKey& key) { return key.key.path == listed; }));
}

// What a table of cloth calls its density is a mass by area.
TEST(LiveValues, HaveTheUnitsOfTheirBodies) {
  const Script script = Script::load(SceneSource("scene.toml", R"([[body]]
name = "sheet"
cloth = { extent = [1, 1], cells = [2, 2] }
material = "silk"
density = 0.05
[[body]]
name = "cube"
box = { extent = [1, 1, 1], cells = [1, 1, 1] }
material = "jelly"
density = 900
)"),
                                     test::assets, {});
  std::string units;
  for (const LiveKey& key : script.live())
    if (key.key.generic == "body[].density") units += key.key.path + " " + key.key.unit + "\n";
  EXPECT_EQ(units, "body.sheet.density kg/m^2\nbody.cube.density kg/m^3\n");
}

TEST_F(Replay, ListsWhatCanChange) {
  const std::vector<LiveKey> live = script("").live();
  const auto find = [&](const std::string& path) -> const LiveKey* {
    for (const LiveKey& key : live) {
      if (key.key.path == path) return &key;
    }
    return nullptr;
  };
  ASSERT_NE(find("body.bar.material.mu"), nullptr);
  EXPECT_TRUE(find("body.bar.material.mu")->cost.factor);
  EXPECT_EQ(find("body.bar.material.mu")->key.unit, "Pa");
  EXPECT_EQ(find("body.bar.material.mu")->key.value, "10000");
  ASSERT_NE(find("gravity"), nullptr);
  EXPECT_FALSE(find("gravity")->cost.factor);
  EXPECT_NE(find("collider.ball.shape.sphere.radius"), nullptr);
  EXPECT_NE(find("camera.fov_deg"), nullptr);
  EXPECT_TRUE(cost_of_change("solver")->factor && cost_of_change("body.bar.solver")->rule);
  EXPECT_EQ(find("frames"), nullptr);
  EXPECT_EQ(find("body.bar.box.cells"), nullptr);
  for (const LiveKey& key : live) EXPECT_TRUE(cost_of_change(key.key.path)) << key.key.path;
}

}  // namespace script_test
}  // namespace supple
