// Tests which bodies of a scene meet: what scenes and replays may say of it, what is refused, and what is said of
// bodies that overlap.
#include "scene/definition/meeting.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "scene/building/assemble.h"
#include "scene/building/body_depths.h"
#include "scene/building/body_passings.h"
#include "scene/building/warnings.h"
#include "scene/replay/script.h"
#include "support/bodies.h"
#include "support/scene_text.h"

namespace supple {
namespace meeting_test {

// A cube with edges of 0.2 m. Its text has five lines before `more`.
std::string cube(const std::string& name, const std::string& more = "") {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }}\nmaterial = \"rubber\"\n{}\n",
      name, more);
}

std::string cloth(const std::string& name, const std::string& more = "") {
  return fmt::format(
      "[[body]]\nname = \"{}\"\ncloth = {{ extent = [0.6, 0.6], cells = [6, 6], stretch = 120 }}\n"
      "turn_deg = [-90, 0, 0]\n{}\n",
      name, more);
}

std::string meets(const std::string& value) { return "contact = { meets = " + value + " }"; }

// Tells of two bodies whether they meet, in either order.
bool both_ways(const SceneDef& scene, std::size_t a, std::size_t b) {
  EXPECT_EQ(meet(scene, a, b), meet(scene, b, a)) << a << " and " << b;
  return meet(scene, a, b);
}

TEST(Meeting, IsWhatAllSolidsDoByDefault) {
  for (const char* more : {"", "contact = {}", "contact = { meets = true }"}) {
    const SceneDef scene = test::scene_of(cube("a", more) + cube("b") + cube("c"));
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) EXPECT_EQ(both_ways(scene, a, b), a != b) << more;
    }
    EXPECT_FALSE(scene.bodies[0].contact.meets);
    EXPECT_EQ(scene.bodies[0].contact.friction, 0.5);
  }
}

TEST(Meeting, WithItselfIsWhatABodyDoesUnlessItSaysOtherwise) {
  const SceneDef scene =
      test::scene_of(cube("a") + cube("b", "contact = { self = false }") + cube("c", meets("false")));
  EXPECT_TRUE(meets_itself(scene.bodies[0]));
  EXPECT_FALSE(meets_itself(scene.bodies[1]));
  EXPECT_TRUE(meet(scene, 0, 1));
  EXPECT_TRUE(meets_itself(scene.bodies[2]));
}

TEST(Meeting, IsLeftOutByABodyThatMeetsNone) {
  for (const char* none : {"false", "[]"}) {
    const SceneDef scene = test::scene_of(cube("a") + cube("b", meets(none)) + cube("c", meets("[\"a\", \"b\"]")));
    EXPECT_FALSE(both_ways(scene, 0, 1));
    EXPECT_FALSE(both_ways(scene, 1, 2)) << "one of both asks for it, and both must allow it";
    EXPECT_TRUE(both_ways(scene, 0, 2));
  }
}

// One table makes bodies 2 to 4.
TEST(Meeting, WithTheNameOfATableIsWithAllBodiesThatItMakes) {
  const std::string copies = "[[scatter]]\nbodies = [\"c\"]\ncount = 3\nbox = [[0, 0, 0], [1, 1, 1]]\n";
  const SceneDef scene = test::scene_of(cube("a", meets("[\"c\"]")) + cube("b") + cube("c") + copies);
  for (std::size_t copy = 2; copy < 5; ++copy) EXPECT_TRUE(both_ways(scene, 0, copy)) << copy;
  EXPECT_FALSE(both_ways(scene, 0, 1));
  const SceneDef own = test::scene_of(cube("a") + cube("c", meets("[\"c\"]")) + copies);
  EXPECT_TRUE(both_ways(own, 1, 2));
  EXPECT_FALSE(both_ways(own, 0, 1));
  EXPECT_EQ(test::problems_of(cube("a", meets("[\"d\"]")) + cube("c") + copies).size(), 1u);
}

TEST(Meeting, OfABodyWithAListIsWithTheseAlone) {
  const SceneDef scene =
      test::scene_of(cube("a", meets("[\"b\"]")) + cube("b") + cube("c") + cube("d", meets("[\"a\"]")));
  EXPECT_TRUE(both_ways(scene, 0, 1));
  EXPECT_FALSE(both_ways(scene, 0, 2));
  EXPECT_FALSE(both_ways(scene, 0, 3)) << "'d' allows 'a', which does not allow 'd'";
  EXPECT_TRUE(both_ways(scene, 1, 2));
  EXPECT_FALSE(both_ways(scene, 1, 3));
}

TEST(Meeting, OfAClothIsWithSolidsClothsAndItself) {
  const SceneDef scene = test::scene_of(cloth("one") + cloth("other") + cube("cube"));
  EXPECT_TRUE(both_ways(scene, 0, 1));
  EXPECT_TRUE(both_ways(scene, 0, 2));
  EXPECT_TRUE(both_ways(scene, 1, 2));
  EXPECT_TRUE(meets_itself(scene.bodies[0]));
}

TEST(Meeting, NeedsOneIntegrator) {
  const std::string midpoint = "solver = { integrator = \"implicit-midpoint\" }\n";
  const SceneDef scene = test::scene_of(cube("a", midpoint) + cube("b", midpoint) + cube("c"));
  EXPECT_TRUE(both_ways(scene, 0, 1));
  EXPECT_FALSE(both_ways(scene, 0, 2));
  EXPECT_FALSE(both_ways(scene, 1, 2));
}

TEST(Meeting, NeedsOnePrecisionOfTheFactor) {
  const SceneDef scene = test::scene_of(cube("a", "solver = { factor = \"double\" }\n") + cube("b") + cube("c"));
  EXPECT_FALSE(both_ways(scene, 0, 1));
  EXPECT_TRUE(both_ways(scene, 1, 2));
}

TEST(Meeting, HasTheGeometricMeanOfBothFrictions) {
  const SceneDef scene =
      test::scene_of(cube("a", "contact = { friction = 0.2 }") + cube("b") + cube("c", "contact = { friction = 0 }"));
  EXPECT_DOUBLE_EQ(pair_friction(scene.bodies[0], scene.bodies[1]), std::sqrt(0.1));
  EXPECT_EQ(pair_friction(scene.bodies[0], scene.bodies[1]), pair_friction(scene.bodies[1], scene.bodies[0]));
  EXPECT_EQ(pair_friction(scene.bodies[0], scene.bodies[2]), 0);
}

using Lines = std::vector<std::string>;

TEST(Meeting, IsRefusedWithOtherThanTrueFalseOrNames) {
  const auto refusal = [](const std::string& value) { return test::problems_of(cube("a", meets(value)) + cube("b")); };
  const std::string allowed = ": must be true, false or a list of names of bodies";
  EXPECT_EQ(refusal("3"), Lines{"scene.toml:5:21: meets = 3" + allowed});
  EXPECT_EQ(refusal("\"b\""), Lines{"scene.toml:5:21: meets = 'b'" + allowed});
  EXPECT_EQ(refusal("[\"b\", 1]"), Lines{"scene.toml:5:21: meets = ['b', 1]" + allowed});
  EXPECT_EQ(test::problems_of(cube("a", "contact = true") + cube("b")).size(), 1u);
  EXPECT_EQ(test::problems_of(cube("a", "contact = { meet = true }")),
            Lines{"scene.toml:5:13: unknown key 'meet'; did you mean 'meets'?"});
}

TEST(Meeting, IsRefusedWithNamesOfNoOtherBody) {
  const auto refusal = [](const std::string& value) {
    return test::problems_of(cube("ball", meets(value)) + cube("block") + cube("box"));
  };
  EXPECT_EQ(refusal("[\"block\", \"bolck\"]"),
            Lines{"scene.toml:5:21: meets = 'bolck': must be the name of another body: block or box; did you mean "
                  "'block'?"});
  EXPECT_EQ(refusal("[\"ball\"]"), Lines{"scene.toml:5:21: meets = 'ball': whether a body meets itself is said by "
                                         "self; must be the name of another body: block or "
                                         "box"});
  EXPECT_EQ(test::problems_of(cube("a", meets("[\"zzz\"]"))),
            Lines{"scene.toml:5:21: meets = 'zzz': must be the name of another body, and there is none"});
}

TEST(Meeting, IsRefusedWhereItIsAskedForByNameAndCannotBe) {
  const std::string midpoint = "solver = { integrator = \"implicit-midpoint\" }\n";
  EXPECT_EQ(test::problems_of(cube("a", meets("[\"b\"]")) + cube("b", midpoint)),
            Lines{"scene.toml:5:21: meets = 'b': body 'a' cannot meet it: bodies that meet need the same "
                  "solver.integrator, and these have 'backward-euler' and 'implicit-midpoint'"});
  EXPECT_EQ(test::problems_of(cube("a", meets("[\"b\"]")) + cube("b", midpoint + meets("false"))), Lines{});
}

TEST(Meeting, HasFrictionsFromNoneToAHundred) {
  const auto refusal = [](const std::string& value) {
    return test::problems_of(cube("a", "contact = { friction = " + value + " }"));
  };
  for (const char* allowed : {"0", "0.5", "3", "100"}) EXPECT_EQ(refusal(allowed), Lines{}) << allowed;
  EXPECT_EQ(refusal("-0.1"), Lines{"scene.toml:5:24: friction = -0.1: must be 0 to 100"});
  EXPECT_EQ(refusal("101"), Lines{"scene.toml:5:24: friction = 101: must be 0 to 100"});
  EXPECT_EQ(refusal("\"much\""), Lines{"scene.toml:5:24: friction = 'much': must be a number, 0 to 100"});
}

// A replay of two cubes, of 60 frames at 30 frames a second.
class MeetingReplay : public testing::Test {
 protected:
  Script script(const std::string& changes) {
    std::ofstream(folder_.path / "cubes.toml") << "frames = 60\n" << cube("a") << cube("b", "position = [1, 0, 0]");
    std::ofstream(folder_.path / "r.toml") << "scene = \"cubes.toml\"\n" << changes;
    return Script::load(folder_.path / "r.toml", test::assets, {});
  }
  std::string refused(const std::string& changes) {
    try {
      (void)script(changes);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  test::TemporaryFolder folder_;
};

TEST_F(MeetingReplay, ChangesWhatMeetsAtNoCost) {
  const Script script = this->script(
      "[[change]]\nt = 1\npath = 'body.a.contact.meets'\nvalue = false\n"
      "[[change]]\nframe = 40\npath = 'body.a.contact.meets'\nvalue = ['b']\n"
      "[[change]]\nt = 0\nover = 1\nease = 'linear'\npath = 'body.b.contact.friction'\nvalue = 1.5\n");
  EXPECT_TRUE(meet(script.scene_at(29), 0, 1));
  EXPECT_FALSE(meet(script.scene_at(30), 0, 1));
  EXPECT_FALSE(meet(script.scene_at(39), 0, 1));
  EXPECT_TRUE(meet(script.scene_at(40), 0, 1));
  EXPECT_NEAR(script.scene_at(14).bodies[1].contact.friction, 1, 1e-9) << "half of the way from the default";
  EXPECT_EQ(script.scene_at(30).bodies[1].contact.friction, 1.5);
  for (const TimedChange& change : script.changes()) EXPECT_STREQ(change.cost.text(), "") << change.path;
}

TEST_F(MeetingReplay, IsListedAmongWhatCanChange) {
  std::vector<std::string> listed;
  for (const LiveKey& key : script("").live()) listed.push_back(key.key.path);
  for (const char* path : {"body.a.contact.meets", "body.a.contact.friction", "body.b.contact.meets"})
    EXPECT_NE(std::ranges::find(listed, path), listed.end()) << path;
}

TEST_F(MeetingReplay, IsRefusedWithTheNameOfNoBodyAndWithAnotherIntegrator) {
  const std::string unknown = refused("[[change]]\nt = 1\npath = 'body.a.contact.meets'\nvalue = ['c']\n");
  EXPECT_NE(unknown.find("r.toml:5:9: meets = 'c': must be the name of another body: b"), std::string::npos) << unknown;
  const std::string other = refused(
      "[set]\n\"body.a.contact.meets\" = ['b']\n"
      "[[change]]\nt = 1\npath = 'body.b.solver.integrator'\nvalue = 'implicit-midpoint'\n");
  EXPECT_NE(other.find("bodies that meet need the same solver.integrator"), std::string::npos) << other;
}

std::string said_of(const std::string& text) {
  const SceneDef scene = test::scene_of(text);
  std::string all;
  for (const Problem& warning : said(warnings(scene, assemble(scene)))) all += warning.message + "\n";
  return all;
}

const std::string in_place = "gravity = [0, 0, 0]\n";

// The middle of the upper cube's lower face is 0.06 m below the lower cube's upper face, and further from its sides.
TEST(MeetingOverlap, AtTheStartIsToldWithItsDepthAndPlace) {
  const std::string text = said_of(in_place + cube("lower") + cube("upper", "position = [0, 0.14, 0]"));
  EXPECT_EQ(
      text.find("bodies 'lower' and 'upper' overlap at the start, by up to 0.06 m (17 % of the smaller one's size) "
                "at ["),
      0u)
      << text;
  EXPECT_NE(text.find(": they are pushed apart gently while the film runs\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("pass through"), std::string::npos) << text;
}

TEST(MeetingOverlap, IsNoneWhereBodiesTouchAndIsNotSaidWhereItIsMeant) {
  EXPECT_EQ(said_of(in_place + cube("a") + cube("b", "position = [0, 0.2, 0]")), "");
  EXPECT_EQ(said_of(in_place + cube("a") + cube("b", "position = [0, 0.19999, 0]")), "") << "0.003 % of its size";
  EXPECT_NE(said_of(in_place + cube("a") + cube("b", "position = [0, 0.199, 0]")), "");
  EXPECT_EQ(said_of(in_place + cube("a") + cube("b", "position = [0, 0.199, 0]\nmeant = [\"overlap\"]")), "");
}

TEST(MeetingOverlap, OfBodiesThatDoNotMeetIsThatTheyPassThroughEachOther) {
  const std::string expected = "bodies 'a' and 'b' pass through each other from the start on: these two do not meet\n";
  EXPECT_EQ(said_of(in_place + cube("a", meets("false")) + cube("b", "position = [0, 0.14, 0]")), expected);
  EXPECT_EQ(said_of(in_place + cube("a") +
                    cube("b",
                         "position = [0, 0.14, 0]\nsolver = { integrator = "
                         "\"implicit-midpoint\" }")),
            expected);
}

TEST(MeetingOverlap, BetweenTheVerticesIsSaidWithoutADepth) {
  const auto bar = [](const std::string& name, const std::string& extent) {
    return fmt::format(
        "[[body]]\nname = \"{}\"\nbox = {{ extent = {}, cells = [1, 1, 1] }}\nmeant = [\"thin\"]\n"
        "material = \"rubber\"\n",
        name, extent);
  };
  EXPECT_EQ(said_of(in_place + bar("along", "[1, 0.1, 0.1]") + bar("across", "[0.1, 0.1, 1]")),
            "bodies 'along' and 'across' overlap at the start, with no vertex of one inside the other: contact finds "
            "vertices, and may leave them there\n");
}

// Two cubes, of which the second one is at a height above the first.
struct Stack {
  std::vector<Body> bodies;

  explicit Stack(const std::string& of_first = "")
      : bodies(assemble(test::scene_of(cube("a", of_first) + cube("b", "position = [0, 1, 0]")))) {}
  std::vector<Positions> at(double height) const {
    std::vector<Positions> points = {bodies[0].description.mesh.rest, bodies[1].description.mesh.rest};
    points[1].col(1).array() += height - 1;
    return points;
  }
};

TEST(DeepBodies, AreFoundOnceAndOnlyBelowOneHundredthOfTheirSize) {
  const Stack stack;
  DeepBodies deep(stack.bodies);
  const double size = 0.2 * std::sqrt(3.0);
  EXPECT_FALSE(deep.none_left());
  EXPECT_TRUE(deep.find(stack.at(0.3)).empty());
  EXPECT_TRUE(deep.find(stack.at(0.2 - 0.009 * size)).empty());
  const std::vector<BodyDepth> found = deep.find(stack.at(0.2 - 0.011 * size));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].a, 0u);
  EXPECT_EQ(found[0].b, 1u);
  EXPECT_NEAR(found[0].depth, 0.011 * size, 1e-9);
  EXPECT_NEAR(found[0].share, 0.011, 1e-9);
  EXPECT_TRUE(deep.none_left());
  EXPECT_TRUE(deep.find(stack.at(0.1)).empty()) << "once a pair";
}

TEST(DeepBodies, AreNotThoseThatPassThroughEachOther) {
  Stack stack(meets("false"));
  DeepBodies deep(stack.bodies);
  BodyPassings passing(stack.bodies);
  EXPECT_TRUE(deep.none_left());
  EXPECT_TRUE(deep.find(stack.at(0.1)).empty());
  stack.bodies[0].def.contact.meets.reset();  // as a replay does
  EXPECT_TRUE(passing.none_left());
  EXPECT_TRUE(passing.find(stack.at(0.1)).empty());
  EXPECT_EQ(deep.find(stack.at(0.1)).size(), 1u);
  stack.bodies[0].def.contact.meets.emplace();
  EXPECT_EQ(passing.find(stack.at(0.1)).size(), 1u);
}

// The cloth lies in the middle of the cube's height. Those of its vertices that are inside are at the distance of the
// nearest side.
TEST(DeepBodies, AreAlsoAClothInASolid) {
  const std::vector<Body> bodies = assemble(test::scene_of(cube("cube") + cloth("cloth", "position = [0, 0.1, 0]")));
  const std::vector<BodyDepth> found =
      DeepBodies(bodies).find({bodies[0].description.mesh.rest, bodies[1].description.mesh.rest});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].depth, 0.1, 1e-9);
  EXPECT_NEAR((found[0].place - Vec3(0, 0.1, 0)).norm(), 0, 1e-9);
}

}  // namespace meeting_test
}  // namespace supple
