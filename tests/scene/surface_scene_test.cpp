// Tests what scenes say of surfaces: how open ones are closed, which pieces become bodies, units and axes, and scenes
// that are a model's file alone.
#include <gtest/gtest.h>

#include <fstream>

#include "geometry/tetrahedra/meshing.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "scene/building/assemble.h"
#include "scene/building/collision_set.h"
#include "scene/building/unplaced_body.h"
#include "scene/definition/meeting.h"
#include "scene/reading/body_pieces.h"
#include "scene/reading/model_scene.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"
#include "support/scene_text.h"
#include "support/surfaces.h"

namespace supple {
namespace surface_scene_test {

using test::obj_text;

class SurfaceScene : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_.path / name) << text; }
  SceneDef scene_of(const std::string& keys) const {
    write("s.toml", "[[body]]\nmaterial = \"jelly\"\nvertices = 600\n" + keys);
    return load_scene(folder_.path / "s.toml", test::assets, {});
  }
  std::string refusal_of(const std::string& keys) const {
    try {
      scene_of(keys);
      return "accepted";
    } catch (const InputError& error) {
      return error.problems().front().message;
    }
  }
  test::TemporaryFolder folder_;
};

TEST_F(SurfaceScene, AScaleEnlargesABodyAfterItsUnitsAndLeavesItsThicknessAsItIs) {
  write("box.obj", obj_text(test::box_surface(Vec3(100, 200, 50))));
  const auto extent = [&](const std::string& keys) {
    return bounds_of(assemble(scene_of("surface = \"box.obj\"\n" + keys)).front().description.mesh.rest).extent();
  };
  EXPECT_LT((extent("units = \"mm\"\nscale = 2\n") - Vec3(0.4, 0.8, 0.2)).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_LT((extent("scale = 1e-3\nturn_deg = [0, 0, 90]\n") - Vec3(0.4, 0.2, 0.1)).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_LT((extent("size = 0.4\n") - extent("scale = 1e-3\n")).cwiseAbs().maxCoeff(), 1e-3);
  write("sheet.obj", "v 0 0 0\nv 100 0 0\nv 100 0 100\nv 0 0 100\nf 1 2 3\nf 1 3 4\n");
  const Vec3 sheet =
      bounds_of(
          assemble(scene_of("surface = \"sheet.obj\"\nscale = 0.01\nthicken = 0.2\n")).front().description.mesh.rest)
          .extent();
  EXPECT_NEAR(sheet.y(), 0.2, 0.01);
  EXPECT_NEAR(sheet.x(), 1, 0.02);
}

TEST_F(SurfaceScene, AScaleThatIsNoneIsRefused) {
  write("box.obj", obj_text(test::box_surface(Vec3(1, 2, 3))));
  EXPECT_EQ(refusal_of("surface = \"box.obj\"\nsize = 1\nscale = 2\n"), "a body has a size or a scale, not both");
  for (const char* scale : {"0", "-1", "1e7", "nan", "\"mm\"", "[1, 1, 2]"})
    EXPECT_NE(refusal_of(std::string("surface = \"box.obj\"\nscale = ") + scale + "\n").find("scale"),
              std::string::npos)
        << scale;
}

TEST_F(SurfaceScene, PiecesApartAreBodiesThatKeepTheirPlaces) {
  write("two.obj", obj_text(test::together(test::box_surface(Vec3(1, 1, 1)),
                                           test::moved(test::box_surface(Vec3(0.5, 0.5, 0.5)), Vec3(3, 0, 0)))));
  const SceneDef scene = scene_of("name = \"toy\"\nsurface = \"two.obj\"\nsize = 0.9\nposition = [0, 1, 0]\n");
  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(scene.bodies[0].name, "toy_1");
  EXPECT_EQ(scene.bodies[1].name, "toy_2");
  EXPECT_EQ(scene.bodies[0].vertices, 533);  // 8/9 of the volume
  EXPECT_EQ(scene.bodies[1].vertices, 100);  // the fewest
  const std::vector<Body> bodies = assemble(scene);
  const Bounds large = bounds_of(bodies[0].description.mesh.rest), small = bounds_of(bodies[1].description.mesh.rest);
  // The whole is 4.5 long, so that a size of 0.9 makes it a fifth.
  EXPECT_NEAR(large.extent().x(), 0.4, 0.01);
  EXPECT_NEAR(small.extent().x(), 0.2, 0.01);
  EXPECT_NEAR(small.center().x() - large.center().x(), 0.6, 0.01);
  EXPECT_NEAR(large.lower.y(), 1, 0.01);
  EXPECT_NEAR(small.lower.y(), 1.1, 0.01);
  EXPECT_EQ(scene.bodies[1].label, "toy_2");
  for (const BodyDef& body : scene_of("surface = \"two.obj\"\n").bodies) EXPECT_EQ(body.label, "") << body.name;
  ASSERT_EQ(bodies[0].notes.size(), 1u);
  EXPECT_EQ(bodies[0].notes[0],
            "the surface has 2 pieces, all of which become bodies of their own (pieces = \"largest\" "
            "takes one)");
  EXPECT_EQ(scene_of("surface = \"two.obj\"\npieces = \"largest\"\n").bodies.size(), 1u);
}

// The pieces have the same list, in which a piece may find its own name.
TEST_F(SurfaceScene, PiecesMeetEachOtherUnlessTheirTableSaysOtherwise) {
  write("two.obj", obj_text(test::together(test::box_surface(Vec3(1, 1, 1)),
                                           test::moved(test::box_surface(Vec3(0.5, 0.5, 0.5)), Vec3(3, 0, 0)))));
  const std::string pieces = "name = \"toy\"\nsurface = \"two.obj\"\n";
  EXPECT_TRUE(meet(scene_of(pieces), 0, 1));
  EXPECT_TRUE(meet(scene_of(pieces + "contact = { meets = [\"toy_1\", \"toy_2\"] }\n"), 0, 1));
  EXPECT_FALSE(meet(scene_of(pieces + "contact = { meets = false }\n"), 0, 1));
  EXPECT_TRUE(meet(scene_of(pieces + "contact = { meets = [\"toy\"] }\n"), 0, 1));
  EXPECT_EQ(refusal_of(pieces + "contact = { meets = [\"tyo\"] }\n"),
            "meets = 'tyo': must be the name of another body: toy_2; did you mean 'toy'?");
}

TEST_F(SurfaceScene, PiecesThatTouchBecomeOneBodyByWhatLiesBetween) {
  // The gap is a four-hundredth of the length, and no element reaches across it by itself.
  write("near.obj", obj_text(test::together(test::box_surface(Vec3(1, 1, 1)),
                                            test::moved(test::box_surface(Vec3(1, 1, 1)), Vec3(2.01, 0, 0)))));
  const SceneDef scene = scene_of("surface = \"near.obj\"\n");
  ASSERT_EQ(scene.bodies.size(), 1u);
  const TetMesh mesh = UnplacedBodies().get(scene, scene.bodies[0]).description.mesh;
  EXPECT_EQ(manifoldness(mesh).pieces, 1);
  EXPECT_NEAR(bounds_of(mesh.rest).extent().x(), 4.01, 0.05);
  EXPECT_EQ(scene_of("surface = \"near.obj\"\npieces = \"bodies\"\n").bodies.size(), 2u);
}

TEST_F(SurfaceScene, WhatIsTooLargeIsRefusedWithAWayOut) {
  write("huge.obj", obj_text(test::box_surface(Vec3(1e8, 1e8, 1e8))));
  const SceneDef scene = scene_of("surface = \"huge.obj\"\n");
  try {
    (void)UnplacedBodies().get(scene, scene.bodies.at(0));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("is larger than 1e6 m"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("`size` or `units`"), std::string::npos) << error.what();
  }
}

TEST_F(SurfaceScene, WhatIsThinnerThanAnElementIsHeldByElementsAroundIt) {
  write("plate.obj", obj_text(test::box_surface(Vec3(1, 1e-3, 0.5))));
  const SceneDef scene = scene_of("surface = \"plate.obj\"\n");
  const Body unplaced = UnplacedBodies().get(scene, scene.bodies.at(0));
  EXPECT_NEAR(double(unplaced.description.mesh.rest.rows()), 600, 60);
  EXPECT_EQ(manifoldness(unplaced.description.mesh).pieces, 1);
  const Vec3 beyond = 0.5 * (bounds_of(unplaced.description.mesh.rest).extent() - Vec3(2, 2e-3, 1));
  EXPECT_GT(beyond.minCoeff(), 0.02);
  ASSERT_EQ(unplaced.notes.size(), 2u);
  EXPECT_NE(unplaced.notes[0].find("thinner than an element of 600 vertices"), std::string::npos) << unplaced.notes[0];
  EXPECT_EQ(unplaced.notes[1].find(fmt::format("the elements reach {:.2g} beyond the surface", beyond.maxCoeff())), 0u)
      << unplaced.notes[1];
}

// A ball with an arm of half an element's thickness: a lattice inside it would hold the ball alone.
TEST_F(SurfaceScene, ThinPartsAreHeldBySmallerElementsThatReachALittleBeyondThem) {
  Shape shape;
  shape.root.parts.emplace_back().primitive = Sphere{0.5};
  shape.root.parts.emplace_back().primitive = Capsule{Vec3::Zero(), Vec3(1.3, 0.2, 0.3), 0.03};
  const TetMesh fine = tetrahedralize(shape, 60000, "arm");
  const TriMesh surface{fine.rest, boundary_faces(fine.tets)};
  write("arm.obj", obj_text(surface));
  const SceneDef scene = scene_of("surface = \"arm.obj\"\n");
  const Body unplaced = UnplacedBodies().get(scene, scene.bodies.at(0));
  const Bounds body = bounds_of(unplaced.description.mesh.rest), skin = bounds_of(surface.points);
  EXPECT_NEAR(body.upper.x(), skin.upper.x(), 0.05);
  EXPECT_NEAR(body.lower.x(), skin.lower.x(), 0.03);
  ASSERT_EQ(unplaced.notes.size(), 1u) << "less than a twentieth of the surface is thin";
  EXPECT_EQ(unplaced.notes[0].find("the elements reach 0.0"), 0u) << unplaced.notes[0];
}

TEST_F(SurfaceScene, SheetsGetTheirThicknessInMetres) {
  write("sheet.obj", "v 0 0 0\nv 200 0 0\nv 200 0 100\nv 0 0 100\nf 1 3 2\nf 1 4 3\n");
  EXPECT_NE(refusal_of("surface = \"sheet.obj\"\n").find("thicken = 0.01"), std::string::npos);
  const SceneDef scene = scene_of("surface = \"sheet.obj\"\nsize = 2\nthicken = 0.2\n");
  const std::vector<Body> bodies = assemble(scene);
  EXPECT_NEAR(bodies.at(0).volume, 2 * 1 * 0.2, 0.02);
}

TEST_F(SurfaceScene, BadValuesAndKeysWithoutASurfaceAreRefused) {
  write("box.obj", obj_text(test::box_surface(Vec3(1, 1, 1))));
  const std::string box = "surface = \"box.obj\"\n";
  EXPECT_EQ(refusal_of(box + "close = \"always\"\n"), "close = 'always': must be auto, caps, winding or never");
  EXPECT_EQ(refusal_of(box + "pieces = \"all\"\n"), "pieces = 'all': must be join, largest or bodies");
  EXPECT_EQ(refusal_of(box + "thicken = -1\n"), "thicken = -1: must be above 0 to 1e+06");
  EXPECT_EQ(refusal_of(box + "up = \"w\"\n"), "up = 'w': must be x, y, z, -x, -y or -z; did you mean 'x'?");
  EXPECT_EQ(refusal_of(box + "units = \"mile\"\n"), "units = 'mile': must be m, cm, mm, km, in or ft");
  for (const char* key : {"close = \"auto\"", "pieces = \"join\"", "thicken = 0.1", "up = \"z\"", "units = \"mm\""}) {
    const std::string name = std::string(key).substr(0, std::string(key).find(' '));
    EXPECT_EQ(refusal_of(fmt::format("box = {{ extent = [1, 1, 1] }}\n{}\n", key)),
              name + ": of a 'surface'; there is none here");
  }
}

TEST_F(SurfaceScene, UnitsAndAxesAreThoseOfTheFile) {
  write("long.obj", obj_text(test::box_surface(Vec3(100, 200, 400))));
  const auto extent = [&](const std::string& keys) {
    const SceneDef scene = scene_of("surface = \"long.obj\"\n" + keys);
    return bounds_of(assemble(scene).at(0).description.mesh.rest).extent();
  };
  EXPECT_LT((extent("units = \"mm\"\n") - Vec3(0.2, 0.4, 0.8)).norm(), 0.02);
  EXPECT_LT((extent("units = \"mm\"\nup = \"z\"\n") - Vec3(0.2, 0.8, 0.4)).norm(), 0.02);
  const std::vector<Body> large = assemble(scene_of("surface = \"long.obj\"\n"));
  ASSERT_EQ(large[0].notes.size(), 1u);
  EXPECT_EQ(large[0].notes[0],
            "body 'body' is 800 m long; size = 0.5 makes it half a metre, and units = \"mm\" takes the "
            "file's numbers for that");
}

TEST_F(SurfaceScene, ASurfaceAsAColliderHasASizeAndAPlace) {
  write("long.obj", obj_text(test::moved(test::box_surface(Vec3(100, 200, 400)), Vec3(7, 7, 7))));
  write("s.toml",
        "[[body]]\nbox = { extent = [1, 1, 1] }\nmaterial = \"jelly\"\nposition = [0, 5, 0]\n[[collider]]\n"
        "shape = { surface = \"long.obj\", size = 2, center = true, up = \"z\" }\n[[collider]]\n"
        "shape = { sphere = { radius = 1 } }\n");
  const SceneDef scene = load_scene(folder_.path / "s.toml", test::assets, {});
  const Bounds box = scene.colliders.at(0).shape.bounds();
  EXPECT_LT((box.extent() - Vec3(0.5, 2, 1)).norm(), 1e-9);
  EXPECT_NEAR(box.lower.y(), 0, 1e-9);
  EXPECT_NEAR(box.center().x(), 0, 1e-9);
  // Of two colliders without a name, the second has a number.
  EXPECT_EQ(scene.colliders[0].name, "collider");
  EXPECT_EQ(scene.colliders[1].name, "collider_2");
}

TEST_F(SurfaceScene, BodiesWithoutANameAreNumberedAndPathsTellThemApart) {
  const std::string box = "[[body]]\nbox = { extent = [1, 1, 1] }\nmaterial = \"jelly\"\n";
  write("s.toml", box + box + box);
  const SceneDef scene = load_scene(folder_.path / "s.toml", test::assets, {"body.body_3.density=77"});
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.bodies[1].name, "body_2");
  EXPECT_FALSE(scene.bodies[1].density);
  EXPECT_EQ(scene.bodies[2].density, 77);
}

TEST_F(SurfaceScene, AModelsFileAloneIsASceneOfIt) {
  const std::string name = "a \"box\".obj";
  write(name, obj_text(test::box_surface(Vec3(1, 1, 1))));
  EXPECT_TRUE(is_model(name));
  EXPECT_FALSE(is_model("scene.toml"));
  const SceneDef scene = load_scene(folder_.path / name, test::assets, {"body.model.vertices=300", "frames=3"});
  EXPECT_EQ(scene.name, "a \"box\"");
  EXPECT_EQ(scene.frames, 3);
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies[0].vertices, 300);
  ASSERT_EQ(scene.colliders.size(), 1u) << "the ground that every film shows";
  EXPECT_LT(collision_set(scene).colliders[0].shape.distance(Vec3(0.3, -1, 0.2)), -0.99);
  EXPECT_NEAR(bounds_of(assemble(scene)[0].description.mesh.rest).extent().maxCoeff(), 0.5, 0.01);
  EXPECT_THROW(load_scene(folder_.path / "none.obj", test::assets, {}), InputError);
}

}  // namespace surface_scene_test
}  // namespace supple
