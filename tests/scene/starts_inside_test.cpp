// Tests bodies that start inside colliders: what is said of them, and what becomes of them.
#include "scene/building/starts_inside.h"

#include <gtest/gtest.h>

#include "scene/building/collision_set.h"
#include "scene/building/warnings.h"
#include "scene/reading/scene_reader.h"
#include "sim/contact/way_out.h"
#include "sim/measures/energies.h"
#include "sim/measures/measures.h"
#include "sim/solver/step.h"
#include "support/bodies.h"
#include "support/scene_text.h"

namespace supple {
namespace starts_inside_test {

constexpr double gravity = 9.81;

struct Start {
  const char* name;
  std::string position;   // of the middle of the cube's bottom
  std::string colliders;  // the first one is what the cube starts in
  bool moved;             // before the first frame; otherwise pushed
};

std::string collider(const std::string& name, const std::string& shape, const std::string& rest = "") {
  return "[[collider]]\nname = \"" + name + "\"\nshape = { " + shape + " }\n" + rest;
}

const std::string ground = collider("ground", "half_space = { normal = [0, 1, 0] }");
const std::string block = collider("block", "box = { extent = [1, 1, 1] }");

std::vector<Start> twelve_starts() {
  return {{"little in the ground", "[0, -0.02, 0]", ground, true},
          {"half in the ground", "[0, -0.1, 0]", ground, false},
          {"little in a block's side", "[0.59, 0, 0]", block, true},
          {"half in a block", "[0, 0.4, 0]", block, false},
          {"half in a block's corner", "[0.5, 0.4, 0.5]", block, false},
          {"wholly in a ball", "[0.05, 0.2, 0]", collider("ball", "sphere = { radius = 0.5 }"), false},
          {"around a small ball", "[0.01, -0.08, 0]", collider("ball", "sphere = { radius = 0.08 }"), false},
          {"cut by a plate", "[0, -0.09, 0]", collider("plate", "box = { extent = [1, 0.1, 1] }"), false},
          {"half in a capsule", "[0, 0.1, 0]",
           collider("capsule", "capsule = { ends = [[-0.5, 0, 0], [0.5, 0, 0]], radius = 0.2 }"), false},
          {"half in the tube of a torus", "[0.5, 0.05, 0]", collider("ring", "torus = { radius = 0.5, tube = 0.15 }"),
           false},
          {"half in a cylinder that is turned", "[0.3, -0.1, 0]",
           collider("drum", "cylinder = { radius = 0.3, height = 0.8 }", "turn_deg = [0, 0, 30]\n"), false},
          {"in a block that stands on the ground", "[0.35, 0, 0]",
           collider("block", "box = { extent = [0.6, 1, 0.6] }", "position = [0, 0.5, 0]\n") + ground, false}};
}

std::string scene_text(const Start& start, const std::string& body = "") {
  return "gravity = [0, 0, 0]\n[[body]]\nname = \"cube\"\nbox = { extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }\n"
         "material = { model = \"neo-hookean\", young = 1e5, poisson = 0.4 }\nposition = " +
         start.position + "\n" + body + start.colliders;
}

// A film of one body among colliders that stand still.
struct StillFilm {
  Body body;
  CollisionSet set;
  Model model;
  State state;
  StepInputs inputs;
  OpenWorkspace w;

  explicit StillFilm(const SceneDef& scene)
      : body(assemble(scene).front()),
        set(collision_set(scene)),
        model(build_model(body.description)),
        state(start_state(model, body)) {
    inputs.gravity = scene.gravity;
    inputs.solver = body.def.solver.settings;
    inputs.targets.resize(0, 3);
    inputs.colliders = &set.colliders;
    for (const SceneCollider& collider : set.scene_colliders)
      inputs.collider_motions.push_back({collider.pose(0), collider.pose(0)});
  }
  Obstacles obstacles() const {
    std::vector<Eigen::Isometry3d> poses;
    for (const ColliderMotion& motion : inputs.collider_motions) poses.push_back(motion.start);
    return Obstacles(set.colliders, poses);
  }
  double deepest() const {
    double deepest = 0;
    for (int v = 0; v < model.vertices; ++v) deepest = std::max(deepest, -obstacles().distance(state.x.row(v)));
    return deepest;
  }
};

TEST(StartsInside, AreNamedWithBodyColliderAndDepth) {
  for (const Start& start : twelve_starts()) {
    SCOPED_TRACE(start.name);
    const SceneDef scene = test::scene_of(scene_text(start));
    const std::vector<Problem> list = said(warnings(scene, assemble(scene)));
    ASSERT_EQ(list.size(), 1u);
    const std::string text = list.front().message;
    EXPECT_NE(text.find("body 'cube' starts "), std::string::npos) << text;
    EXPECT_NE(text.find(" m deep inside collider '" + scene.colliders.front().name + "'"), std::string::npos) << text;
    EXPECT_NE(text.find(start.moved ? "it is moved out by" : "it is pushed out"), std::string::npos) << text;
  }
  const SceneDef scene = test::scene_of(scene_text(twelve_starts().front()));
  EXPECT_EQ(warnings(scene, assemble(scene)).front().problem.message,
            "body 'cube' starts 0.02 m deep inside collider 'ground' (5.8 % of its size): it is moved out by (0, 0.02, "
            "0) m before the first frame");
}

TEST(StartsInside, EndWithTheBodyOutsideWholeAndWithNoMoreEnergyThanLiftingItOutCosts) {
  for (const Start& start : twelve_starts()) {
    for (const bool push : {false, true}) {
      SCOPED_TRACE(std::string(start.name) + (push ? ", pushed" : ""));
      StillFilm film(test::scene_of(scene_text(start, push ? "start_inside = \"push\"\n" : "")));
      const bool moved = start.moved && !push;
      EXPECT_EQ(film.deepest() <= 1e-9, moved);
      const std::optional<WayOut> way = way_out(film.obstacles(), film.model.rest, 0, 10);
      ASSERT_TRUE(way.has_value());
      const double allowed = film.model.total_mass * gravity * way->distance;
      double energy = 0, stretch = 1;
      for (int frame = 0; frame < 90; ++frame) {
        ASSERT_FALSE(step(film.model, film.inputs, film.state, film.w).failed);
        const Energies now = energies(film.model, film.state, film.inputs.gravity, film.w);
        energy = std::max(energy, now.kinetic + now.elastic);
        stretch = std::max(stretch, deformation(film.model, film.state.x).stretch);
      }
      EXPECT_LE(energy, moved ? 1e-6 : allowed);
      EXPECT_LT(stretch, 1.5);
      EXPECT_LT(film.deepest(), 1e-3 * film.model.size);
      const Deformation end = deformation(film.model, film.state.x);
      EXPECT_LT(end.stretch, 1.02);
      EXPECT_EQ(end.inverted, 0);
    }
  }
}

// A cube of 0.2 m with cells of 0.05 m, and posts of 0.02 m that come in by one of its faces or cut it through.
TEST(StartsInside, BetweenVerticesAreNamedAndMovedOutOfOrSaidToStay) {
  const auto text_with = [](const std::string& extent, const std::string& place, const std::string& body = "") {
    const Start start{"", "[0, 0, 0]",
                      collider("post", "box = { extent = " + extent + " }", "position = " + place + "\n"), true};
    const Body made = assemble(test::scene_of(scene_text(start, body))).front();
    return start_inside_text(made);
  };
  const std::string post = "[0.02, 0.1, 0.02]", plate = "[1, 0.02, 1]";
  const std::string by_post = text_with(post, "[0.025, -0.03, 0.025]");
  EXPECT_NE(by_post.find(", between its vertices): it is moved out by (0, 0.0"), std::string::npos) << by_post;
  EXPECT_EQ(text_with(post, "[0.05, -0.03, 0.05]").find("between"), std::string::npos) << "a vertex is in it";
  EXPECT_NE(text_with(plate, "[0, 0.125, 0]").find("leaves it there; solver.contact.points = \"surface\" does"),
            std::string::npos)
      << text_with(plate, "[0, 0.125, 0]");
  EXPECT_NE(text_with(plate, "[0, 0.125, 0]", "solver.contact.points = \"surface\"\n").find("it is pushed out"),
            std::string::npos);
  EXPECT_EQ(text_with(post, "[0.025, -0.051, 0.025]"), "") << "it stands a millimetre below";
}

TEST(StartsInside, AreRefusedWhenTheSceneSaysSo) {
  const SceneDef scene = test::scene_of(scene_text(twelve_starts()[3], "start_inside = \"error\"\n"));
  try {
    (void)assemble(scene);
    FAIL() << "it was accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "scene.toml:2:1: body 'cube' starts 0.1 m deep inside collider 'block' (29 % of its size): "
                 "start_inside = \"error\" refuses that");
  }
}

TEST(StartsInside, BodiesThatAreHeldStayWhereTheirHandlesAre) {
  const SceneDef scene = test::scene_of(scene_text(
      twelve_starts().front(), "handles = [{ name = \"top\", select = { box = [[0, 1, 0], [1, 1, 1]] } }]\n"));
  const Body body = assemble(scene).front();
  EXPECT_TRUE(body.start_move.isZero(0));
  EXPECT_NE(start_inside_text(body).find("handles hold it in its place, so it is pushed out"), std::string::npos);
}

// A body that touches, or lies a thousandth of its size above, is no overlap.
TEST(StartsInside, TouchingIsNone) {
  for (const char* position : {"[0, 0, 0]", "[0, 0.0003, 0]", "[0, -0.00003, 0]"}) {
    const SceneDef scene = test::scene_of(scene_text({"", position, ground, false}));
    EXPECT_TRUE(assemble(scene).front().starts_inside.empty()) << position;
    EXPECT_TRUE(warnings(scene, assemble(scene)).empty()) << position;
  }
}

// Tests what check says of a body above the ground that every film shows.
TEST(DrawnGround, ABodyThatFallsThroughItIsNamed) {
  const auto said = [](const std::string& more) {
    const SceneDef scene = test::scene_of(
        "frames = 60\n[[body]]\nname = \"cube\"\nbox = { extent = [0.2, 0.2, 0.2], cells = [2, 2, 2] }\n"
        "material = \"jelly\"\nposition = [0, 1, 0]\n" +
        more);
    std::string all;
    for (const Problem& warning : supple::said(warnings(scene, assemble(scene)))) all += warning.message + "\n";
    return all;
  };
  EXPECT_TRUE(said("").starts_with("body 'cube' falls through the ground that the film shows: ")) << said("");
  EXPECT_NE(said(collider("wall", "box = { extent = [1, 1, 1] }", "position = [5, 0, 0]\n")), "");
  EXPECT_EQ(said(ground), "");
  EXPECT_EQ(said(collider("table", "box = { extent = [1, 0.1, 1] }", "position = [0, 0.5, 0]\n")), "");
  EXPECT_EQ(said("handles = [{ name = \"top\", select = { box = [[0, 1, 0], [1, 1, 1]] } }]\n"), "");
  EXPECT_EQ(said("velocity = [0, 40, 0]\n"), "");  // it does not come down in these two seconds
}

}  // namespace starts_inside_test
}  // namespace supple
