// Tests colliders of scene files: every key, what is refused and with which messages, where colliders are at a time,
// and what is drawn of them; also bodies made of surface files.
#include <gtest/gtest.h>

#include <fstream>

#include "scene/building/collision_set.h"
#include "scene/building/drawn_body.h"
#include "scene/building/unplaced_body.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"
#include "support/scene_text.h"
#include "support/surfaces.h"

namespace supple {
namespace collider_test {

using Messages = std::vector<std::string>;

// The body takes three lines, so that what is added begins in the fourth.
const std::string body = "[[body]]\nbox = { extent = [1, 1, 1] }\nmaterial = \"jelly\"\n";

Messages problems_with(const std::string& text) { return test::problems_of(body + text); }

SceneCollider collider_of(const std::string& keys) {
  return collision_set(test::scene_of(body + "[[collider]]\n" + keys)).scene_colliders.at(0);
}

template <class Kind>
const Kind& primitive_of(const ColliderDef& collider) {
  return std::get<Kind>(collider.shape.root.parts.at(0).primitive);
}

TEST(ColliderFile, EveryKeyIsRead) {
  const SceneDef scene = test::scene_of(body + R"([[collider]]
name = "hammer"
shape = { box = { extent = [0.2, 0.4, 0.6], round = 0.05 }, position = [0, 1, 0], scale = 2 }
position = [1, 2, 3]
turn_deg = [10, 20, 30]
friction = 0.7
thickness = 0.01
ease = "linear"
keys = [{ t = 0.5, move = [1, 0, 0] }, { t = 1, turn_deg = [0, 90, 0] }]
visible = false
color = [0.1, 0.2, 0.3]
)");
  ASSERT_EQ(scene.colliders.size(), 1u);
  const ColliderDef& c = scene.colliders[0];
  EXPECT_EQ(c.name, "hammer");
  EXPECT_EQ(primitive_of<Box>(c).half, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(primitive_of<Box>(c).round, 0.05);
  EXPECT_NEAR(c.shape.distance(Vec3(0, 2, 0)), 0.6, 1e-12);
  EXPECT_EQ(c.position, Vec3(1, 2, 3));
  EXPECT_EQ(c.turn_deg, Vec3(10, 20, 30));
  EXPECT_EQ(c.friction, 0.7);
  EXPECT_EQ(c.thickness, 0.01);
  EXPECT_EQ(c.ease, Ease::linear);
  ASSERT_EQ(c.keys.size(), 2u);
  EXPECT_EQ(c.keys[0].time, 0.5);
  EXPECT_EQ(c.keys[0].move, Vec3(1, 0, 0));
  EXPECT_EQ(c.keys[1].turn_deg, Vec3(0, 90, 0));
  EXPECT_FALSE(c.visible);
  EXPECT_EQ(c.color, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(c.place.line, 4);
  const CollisionSet set = collision_set(scene);
  ASSERT_EQ(set.colliders.size(), 1u);
  EXPECT_EQ(set.colliders[0].name, "hammer");
  EXPECT_EQ(set.colliders[0].friction, 0.7);
  EXPECT_EQ(set.colliders[0].thickness, 0.01);
  EXPECT_EQ(set.colliders[0].shape.root.parts.size(), 1u);
}

TEST(ColliderFile, KeysThatAreLeftOutHaveDefaults) {
  const ColliderDef c = collider_of("shape = { sphere = { radius = 0.5 } }").def;
  EXPECT_EQ(c.name, "collider");
  EXPECT_EQ(c.position, Vec3(0, 0, 0));
  EXPECT_EQ(c.turn_deg, Vec3(0, 0, 0));
  EXPECT_EQ(c.friction, 0);
  EXPECT_EQ(c.thickness, 0);
  EXPECT_EQ(c.ease, Ease::smooth);
  EXPECT_TRUE(c.keys.empty() && c.visible && !c.color);
}

TEST(ColliderFile, AShapeIsAPartAShapeFileOrASurface) {
  EXPECT_EQ(primitive_of<Sphere>(collider_of("shape = { sphere = { radius = 0.5 } }").def).radius, 0.5);
  const ColliderDef squirrel = collider_of("shape = \"shapes/squirrel.toml\"").def;
  EXPECT_GT(squirrel.shape.root.parts.size(), 3u);
  EXPECT_GT(squirrel.shape.paint.size(), 0u);
  const ColliderDef stairs = collider_of("shape = { surface = \"surfaces/stairs.obj\" }").def;
  EXPECT_EQ(primitive_of<ClosedSurface>(stairs).solid->surface().points.rows(), 24);
  EXPECT_NEAR(stairs.shape.distance(Vec3(0, 1, 0)), 0.1, 1e-6);
}

TEST(ColliderFile, EachProblemIsSaidOnceWithItsPlace) {
  const std::string ball = "shape = { sphere = { radius = 1 } }\n";
  EXPECT_EQ(problems_with("[[collider]]\n" + ball), Messages{});
  EXPECT_EQ(problems_with("[[collider]]\n" + ball + "[[collider]]\nname = \"collider\"\n" + ball),
            Messages{"scene.toml:7:8: two colliders named 'collider'"});
  EXPECT_EQ(problems_with("[[collider]]\nname = \"ball\"\n"),
            Messages{"scene.toml:4:1: a collider needs a 'shape', such as shape = { sphere = { radius = 0.5 } }"});
  EXPECT_EQ(problems_with("[[collider]]\nshape = 3\n"), Messages{"scene.toml:5:9: shape = 3: must be a table"});
  EXPECT_EQ(
      problems_with("[[collider]]\nshape = {}\n"),
      Messages{"scene.toml:5:9: a part needs one of sphere, ellipsoid, capsule, round_cone, box, cylinder, torus, "
               "half_space, surface, parts"});
  EXPECT_EQ(problems_with("[[collider]]\nshape = { sphere = { radius = -1 } }\n"),
            Messages{"scene.toml:5:31: radius = -1: must be above 0 to 1e+06"});
  EXPECT_EQ(problems_with("[[collider]]\nshape = { half_space = { normal = [0, 0, 0] } }\n"),
            Messages{"scene.toml:5:35: normal: must not be zero"});
  EXPECT_EQ(
      problems_with("[[collider]]\nshape = \"shapes/squirel.toml\"\n"),
      Messages{"scene.toml:5:9: shape = 'shapes/squirel.toml': no such file (looked for shapes/squirel.toml and " +
               (test::assets / "shapes/squirel.toml").string() + "); did you mean 'shapes/squirrel.toml'?"});
  for (const char* name : {"a b", "a.b", "a,b", "a/b", ""})
    EXPECT_EQ(problems_with(fmt::format("[[collider]]\nname = \"{}\"\n{}", name, ball)),
              Messages{fmt::format("scene.toml:5:8: name = '{}': must be a word without spaces, dots, commas, quotes "
                                   "and slashes",
                                   name)});
  EXPECT_EQ(problems_with("[[collider]]\nshape = { sphere = { radius = 1 }, op = \"cut\" }\n"),
            Messages{"scene.toml:5:41: op: the first part must be added; there is nothing to cut or intersect yet"});
  EXPECT_EQ(problems_with("[[collider]]\n" + ball + "friction = -0.1\n"),
            Messages{"scene.toml:6:12: friction = -0.1: must be 0 to 100"});
  EXPECT_EQ(problems_with("[[collider]]\n" + ball + "thickness = -1\n"),
            Messages{"scene.toml:6:13: thickness = -1: must be at least 0"});
  EXPECT_EQ(problems_with("[[collider]]\n" + ball + "keys = [{ t = 1 }, { t = 0.5 }]\n"),
            Messages{"scene.toml:6:26: t = 0.5: keys must stand in order of time (the one before is at 1)"});
  EXPECT_EQ(problems_with("[[collider]]\n" + ball + "stiffness = 3\n"),
            Messages{"scene.toml:6:1: unknown key 'stiffness'; did you mean 'thickness'?"});
}

TEST(ColliderFile, SettingsReachEveryColliderByItsName) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << body << R"([[collider]]
name = "ball"
shape = { sphere = { radius = 1 } }
keys = [{ t = 0 }, { t = 1, move = [1, 0, 0] }]
[[collider]]
name = "wall"
shape = { box = { extent = [1, 1, 1] } }
)";
  const auto scene_with = [&](const std::vector<std::string>& settings) {
    return load_scene(folder.path / "s.toml", test::assets, settings);
  };
  const SceneDef scene = scene_with(
      {"collider.wall.position=[1, 2, 3]", "collider.ball.shape.sphere.radius=0.25", "collider.ball.friction=0.5"});
  EXPECT_EQ(scene.colliders[0].position, Vec3(0, 0, 0));
  EXPECT_EQ(scene.colliders[1].position, Vec3(1, 2, 3));
  EXPECT_EQ(primitive_of<Sphere>(scene.colliders[0]).radius, 0.25);
  EXPECT_EQ(scene.colliders[0].friction, 0.5);
  EXPECT_EQ(scene.colliders[1].friction, 0);
  try {
    (void)scene_with({"collider.bal.friction=1"});
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "--set collider.bal.friction=1: there is no collider named 'bal' (there is ball or wall); did you mean "
        "'ball'?");
  }
}

// Returns the position of the collider's point (1, 0, 0).
Vec3 tip(const SceneCollider& collider, double time) { return collider.pose(time) * Vec3(1, 0, 0); }

TEST(SceneCollider, StandsAtItsPositionTurnedAboutItsOrigin) {
  const SceneCollider still =
      collider_of("shape = { sphere = { radius = 1 } }\nposition = [1, 2, 3]\nturn_deg = [90, 0, 90]\n");
  for (const double time : {0.0, 1.0, 100.0}) {
    EXPECT_LT((still.pose(time) * Vec3(0, 0, 0) - Vec3(1, 2, 3)).norm(), 1e-12);
    EXPECT_LT((tip(still, time) - Vec3(1, 3, 3)).norm(), 1e-12);
    EXPECT_LT((still.pose(time) * Vec3(0, 1, 0) - Vec3(1, 2, 4)).norm(), 1e-12);  // turned about x, then z
  }
}

TEST(SceneCollider, KeysMoveItFromThereAndTurnItAboutItsOrigin) {
  const std::string text = R"(shape = { sphere = { radius = 1 }, position = [5, 5, 5] }
position = [1, 2, 3]
turn_deg = [0, 90, 0]
keys = [{ t = 1 }, { t = 2, move = [0, 1, 0], turn_deg = [0, 0, 180] }, { t = 3, move = [2, 1, 0], turn_deg = [0, 0, 180] }]
)";
  const SceneCollider smooth = collider_of(text), linear = collider_of(text + "ease = \"linear\"\n");
  const auto origin = [](const SceneCollider& collider, double time) {
    return Vec3(collider.pose(time).translation());
  };
  for (const SceneCollider& collider : {smooth, linear}) {
    for (const double time : {0.0, 1.0}) {
      EXPECT_LT((origin(collider, time) - Vec3(1, 2, 3)).norm(), 1e-12) << time;
      EXPECT_LT((tip(collider, time) - Vec3(1, 2, 2)).norm(), 1e-12) << time;
    }
    EXPECT_LT((origin(collider, 1.5) - Vec3(1, 2.5, 3)).norm(), 1e-12);
    EXPECT_LT((collider.pose(1.5) * Vec3(0, 1, 0) - Vec3(0, 2.5, 3)).norm(), 1e-12);
    EXPECT_LT((origin(collider, 2) - Vec3(1, 3, 3)).norm(), 1e-12);
    EXPECT_LT((collider.pose(2) * Vec3(0, 1, 0) - Vec3(1, 2, 3)).norm(), 1e-12);
    for (const double time : {3.0, 7.0}) EXPECT_LT((origin(collider, time) - Vec3(3, 3, 3)).norm(), 1e-12) << time;
  }
  EXPECT_NEAR(origin(linear, 1.25).y(), 2.25, 1e-12);
  EXPECT_NEAR(origin(smooth, 1.25).y(), 2 + 0.25 * 0.25 * 2.5, 1e-12);
}

TEST(SceneCollider, AStepsMotionIsThePoseAtItsTwoEnds) {
  const CollisionSet set = collision_set(test::scene_of(body + R"([[collider]]
name = "a"
shape = { sphere = { radius = 1 } }
ease = "linear"
keys = [{ t = 0 }, { t = 1, move = [0, 0, 4], turn_deg = [0, 0, 90] }]
[[collider]]
name = "b"
shape = { sphere = { radius = 1 } }
position = [7, 0, 0]
)"));
  std::vector<ColliderMotion> motions(5);
  collider_motions(set, {0.25, 0.5}, motions);
  ASSERT_EQ(motions.size(), 2u);
  EXPECT_TRUE(motions[0].start.isApprox(set.scene_colliders[0].pose(0.25)));
  EXPECT_TRUE(motions[0].end.isApprox(set.scene_colliders[0].pose(0.5)));
  EXPECT_LT((motions[0].start.translation() - Vec3(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((motions[0].end.translation() - Vec3(0, 0, 2)).norm(), 1e-12);
  EXPECT_LT((motions[1].start.translation() - Vec3(7, 0, 0)).norm(), 1e-12);
  EXPECT_TRUE(motions[1].end.isApprox(motions[1].start));
}

TEST(SceneCollider, OnlyTheStillHalfSpaceBelowZeroIsTheGround) {
  EXPECT_TRUE(is_ground(collider_of("shape = { half_space = { normal = [0, 2, 0] } }")));
  EXPECT_TRUE(is_ground(collider_of("shape = { half_space = { normal = [0, 1, 0] } }\nposition = [3, 0, -2]")));
  EXPECT_TRUE(
      is_ground(collider_of("shape = { half_space = { normal = [0, 1, 0], offset = 0.5 } }\n"
                            "position = [0, -0.5, 0]")));
  EXPECT_TRUE(is_ground(collider_of("shape = { half_space = { normal = [1, 0, 0] } }\nturn_deg = [0, 0, 90]")));
  for (const char* other :
       {"shape = { half_space = { normal = [0, -1, 0] } }", "shape = { half_space = { normal = [0.01, 1, 0] } }",
        "shape = { half_space = { normal = [0, 1, 0], offset = 0.1 } }",
        "shape = { half_space = { normal = [0, 1, 0] } }\nposition = [0, 0.1, 0]",
        "shape = { half_space = { normal = [0, 1, 0] } }\nturn_deg = [1, 0, 0]",
        "shape = { half_space = { normal = [0, 1, 0] } }\nkeys = [{ t = 0, move = [0, 1, 0] }]",
        "shape = { box = { extent = [9, 9, 9] } }\nposition = [0, -4.5, 0]"})
    EXPECT_FALSE(is_ground(collider_of(other))) << other;
}

Bounds around_bodies() {
  Bounds box;
  box.include(Vec3(-1, 0, -2));
  box.include(Vec3(3, 1, 2));
  return box;
}

TEST(SceneCollider, OfAHalfSpaceASquareIsDrawnThatReachesBeyondTheBodies) {
  const SceneCollider slope = collider_of(
      "shape = { half_space = { normal = [0, 1, 0] }, position = [0, 0.5, 0] }\nposition = [10, 0, 4]\n"
      "turn_deg = [0, 0, 20]\n");
  const Bounds around = around_bodies();
  const Skin skin = drawn_collider(slope, around);
  ASSERT_GT(skin.rest.points.rows(), 3);
  EXPECT_EQ(skin.occlusion.size(), std::size_t(skin.rest.points.rows()));
  EXPECT_EQ(skin.paint.size(), std::size_t(skin.rest.points.rows()));
  const Bounds box = bounds_of(skin.rest.points);
  EXPECT_NEAR(box.lower.y(), 0.5, 1e-12);
  EXPECT_NEAR(box.upper.y(), 0.5, 1e-12);
  EXPECT_NEAR(box.extent().x(), 3 * around.diagonal(), 1e-9);
  EXPECT_NEAR(box.extent().z(), 3 * around.diagonal(), 1e-9);
  const Vec3 middle = slope.rest.inverse() * around.center();
  EXPECT_NEAR(box.center().x(), middle.x(), 1e-9);
  EXPECT_NEAR(box.center().z(), middle.z(), 1e-9);
  for (const auto& t : skin.rest.triangles.rowwise()) {
    const Vec3 a = skin.rest.points.row(t.x()), b = skin.rest.points.row(t.y()), c = skin.rest.points.row(t.z());
    EXPECT_GT((b - a).cross(c - a).y(), 0);  // seen from above
  }
}

TEST(SceneCollider, OfABoxItsSurfaceIsDrawnWithEdges) {
  const SceneCollider box = collider_of(
      "shape = { box = { extent = [0.2, 0.4, 0.8] }, position = [0, 0, 1] }\n"
      "position = [5, 5, 5]\n");
  const Skin skin = drawn_collider(box, around_bodies());
  const Bounds drawn = bounds_of(skin.rest.points);
  EXPECT_LT((drawn.lower - Vec3(-0.1, -0.2, 0.6)).norm(), 0.01);  // in the collider's own frame
  EXPECT_LT((drawn.upper - Vec3(0.1, 0.2, 1.4)).norm(), 0.01);
  const double volume = test::six_volumes(skin.rest) / 6;
  EXPECT_NEAR(volume, 0.2 * 0.4 * 0.8, 0.01 * volume);
  EXPECT_GT(skin.rest.points.rows(), contour(box.def.shape, 0.8 / 96).points.rows());  // creases double vertices
  EXPECT_EQ(skin.occlusion.size(), std::size_t(skin.rest.points.rows()));
  EXPECT_EQ(skin.paint.size(), std::size_t(skin.rest.points.rows()));
}

TEST(SceneCollider, OfASurfaceItsOwnTrianglesAreDrawn) {
  const SceneCollider stairs = collider_of(
      "shape = { surface = \"surfaces/stairs.obj\", scale = 2, turn_deg = [0, 90, 0], position = [0, 0, 3] }");
  const Skin skin = drawn_collider(stairs, around_bodies());
  EXPECT_EQ(skin.rest.triangles.rows(), primitive_of<ClosedSurface>(stairs.def).solid->surface().triangles.rows());
  const Bounds drawn = bounds_of(skin.rest.points);
  EXPECT_LT((drawn.lower - Vec3(-1, 0, 1.6)).norm(), 1e-6);
  EXPECT_LT((drawn.upper - Vec3(3.2, 1.8, 4.4)).norm(), 1e-6);
  for (const auto& p : skin.rest.points.rowwise()) EXPECT_NEAR(stairs.def.shape.distance(p), 0, 1e-12);
}

TEST(SceneCollider, OfTheGroundAndOfWhatIsInvisibleNothingIsDrawn) {
  EXPECT_EQ(drawn_collider(collider_of("shape = { half_space = { normal = [0, 1, 0] } }"), around_bodies())
                .rest.points.rows(),
            0);
  EXPECT_EQ(drawn_collider(collider_of("shape = { sphere = { radius = 1 } }\nvisible = false"), around_bodies())
                .rest.points.rows(),
            0);
}

TEST(SurfaceBody, IsMeshedWithItsNotesItsRegionsAndItsSkin) {
  const test::TemporaryFolder folder;
  TriMesh block = test::box_surface(Vec3(0.5, 0.25, 0.25));
  block.triangles.conservativeResize(13, 3);
  block.triangles.row(12) = block.triangles.row(3);
  std::ofstream(folder.path / "block.obj") << test::obj_text(block);
  std::ofstream(folder.path / "s.toml") << "[[body]]\nsurface = \"block.obj\"\nvertices = 400\nposition = [0, 2, 0]\n"
                                           "material = \"jelly\"\n";
  const SceneDef scene = load_scene(folder.path / "s.toml", test::assets, {});
  const Body unplaced = UnplacedBodies().get(scene, scene.bodies.at(0));
  EXPECT_EQ(unplaced.regions, std::vector<std::string>{""});
  EXPECT_EQ(unplaced.notes, std::vector<std::string>{"1 triangles that repeat others were left out"});
  EXPECT_EQ(unplaced.source, (folder.path / "block.obj").string());
  EXPECT_NEAR(double(unplaced.description.mesh.rest.rows()), 400, 12);
  EXPECT_NEAR(quality(unplaced.description.mesh).volume, 0.25, 0.01);
  const std::vector<Body> bodies = assemble(scene);
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_EQ(bodies[0].notes, unplaced.notes);
  EXPECT_EQ(bodies[0].skin.triangles.rows(), 12);
  EXPECT_EQ(bodies[0].description.materials.size(), 1u);
  const Bounds placed = bounds_of(bodies[0].description.mesh.rest);
  EXPECT_NEAR(placed.lower.y(), 2, 1e-9);
  EXPECT_LT((placed.extent() - Vec3(1, 0.5, 0.5)).norm(), 0.02);
  const DrawnBody drawn = drawn_bodies(bodies).front();
  EXPECT_GT(drawn.skin.rest.triangles.rows(), 100);  // large triangles are refined
  EXPECT_NEAR(bounds_of(drawn.skin.rest.points).extent().x(), 1, 1e-9);
  EXPECT_NEAR(bounds_of(drawn.skin.rest.points).center().y(), placed.center().y(), 0.02);
}

}  // namespace collider_test
}  // namespace supple
