// Tests where captions stand: beside their bodies, over no other caption, and over no body, in all scenes that ship and
// at several sizes of the picture.
#include "render/caption_layout.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/convex_hull.h"
#include "film/pictures/camera.h"
#include "film/pictures/film_graphs.h"
#include "film/pictures/film_stage.h"
#include "film/pictures/surface_field.h"
#include "film/plan/shipped_files.h"
#include "render/captions.h"
#include "render/legend.h"
#include "render/overlays.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"

namespace supple {
namespace caption_layout_test {

const Outline square = {{100, 100}, {200, 100}, {200, 200}, {100, 200}};

TEST(CaptionLayout, TellsRectanglesFromOutlinesThatAreOnlyNear) {
  EXPECT_TRUE(overlaps({150, 150, 10, 10}, square));
  EXPECT_FALSE(overlaps({200, 150, 10, 10}, square));
  const Outline rhombus = {{100, 50}, {150, 100}, {100, 150}, {50, 100}};
  EXPECT_FALSE(overlaps({50, 50, 20, 20}, rhombus)) << "in the box of the outline, and beside the outline";
  EXPECT_TRUE(overlaps({50, 50, 40, 40}, rhombus));
  EXPECT_FALSE(overlaps({0, 0, 10, 10}, {}));
}

TEST(CaptionLayout, MakesTheConvexHullOfPoints) {
  const Outline hull = hull_of({{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 0.5}});
  EXPECT_EQ(hull.size(), 4u);
  EXPECT_TRUE(overlaps({1, 1, 1, 1}, hull));
}

TEST(CaptionLayout, PutsCaptionsBelowWhatTheyWouldCover) {
  const auto places = caption_places({{{150, 150}, 40, 10}, {{150, 150}, 40, 10}}, {{square}, {}, 400, 300});
  ASSERT_TRUE(places);
  EXPECT_FALSE((*places)[0].overlaps((*places)[1]));
  for (const PixelRect& place : *places) EXPECT_FALSE(overlaps(place, square));
  EXPECT_FALSE(caption_places({{{150, 150}, 40, 10}}, {{square}, {}, 400, 205})) << "there is no room below";
  EXPECT_FALSE(caption_places({{{150, 150}, 500, 10}}, {{}, {}, 400, 300})) << "it is wider than the picture";
}

TEST(CaptionLayout, PutsCaptionsAboveWhereTheyWantIt) {
  const auto places =
      caption_places({{{150, 90}, 40, 10, CaptionSide::above}}, {{square}, {{100, 78, 100, 20}}, 400, 300});
  ASSERT_TRUE(places);
  EXPECT_LE(places->front().bottom(), 78) << "it gives way upwards";
  EXPECT_FALSE(caption_places({{{150, 9}, 40, 10, CaptionSide::above}}, {{square}, {}, 400, 300}));
}

TEST(CaptionLayout, RefusesPlacesThatAreNotNear) {
  const std::vector<WantedCaption> three(3, {{150, 210}, 40, 9});
  const CaptionRoom room = {{square}, {}, 400, 300};
  EXPECT_TRUE(caption_places(three, room, CaptionReach::anywhere));
  EXPECT_FALSE(caption_places(three, room, CaptionReach::near)) << "one of them has to stand two rows below";
  EXPECT_TRUE(caption_places({three.front()}, room, CaptionReach::near));
}

struct Size {
  int width, height;
};

// Holds a scene's first picture, and where its captions stand there.
struct LaidOut {
  Stage stage;
  std::vector<Captions::Placed> captions;

  Outline outline_of(std::size_t mesh) const {
    return Projection(stage.first_camera, framed_at_start(stage), stage.width, stage.height)
        .outline(stage.meshes[mesh].rest);
  }
};

LaidOut laid_out(const SceneDef& scene) {
  const std::vector<Body> bodies = assemble(scene);
  const CollisionSet set = collision_set(scene);
  LaidOut result = {make_stage(scene, bodies, std::vector<DrawnBody>(bodies.size()), set.scene_colliders,
                               collider_skins(set.scene_colliders, bodies), text_font()),
                    {}};
  result.stage.first_camera = camera_at(scene, result.stage, 0);
  result.captions = Captions(result.stage).places(result.stage.first_camera);
  return result;
}

// Holds the left, right, upper and lower end of an outline [pixels].
struct Ends {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;

  explicit Ends(const Outline& outline) {
    for (const Eigen::Vector2d& corner : outline) {
      left = std::min(left, corner.x());
      right = std::max(right, corner.x());
      top = std::min(top, corner.y());
      bottom = std::max(bottom, corner.y());
    }
  }
  double middle() const { return (left + right) / 2; }
};

double middle_of(const PixelRect& place) { return place.x + 0.5 * place.width; }

SceneDef shipped_at(const std::string& name, const Size& size) {
  return load_scene(test::assets / "scenes" / (name + ".toml"), test::assets,
                    {"output.width=" + std::to_string(size.width), "output.height=" + std::to_string(size.height)});
}

// These bodies stand on the ground, so that captions belong right below them.
TEST(Captions, InAPictureTallerThanWideStandBelowTheirOwnBodies) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  for (const Size size : {Size{720, 1280}, Size{1080, 1920}}) {
    for (const char* name : {"squirrel", "materials", "strain-limiting"}) {
      const LaidOut picture = laid_out(shipped_at(name, size));
      ASSERT_EQ(picture.captions.size(), picture.stage.meshes.size()) << name;
      for (const Captions::Placed& caption : picture.captions) {
        const Ends body(picture.outline_of(caption.mesh));
        const auto& label = picture.stage.meshes[caption.mesh].label;
        EXPECT_LT(caption.place.y - body.bottom, caption.place.height) << name << ": " << label;
        EXPECT_LT(caption.place.height, size.width / 15) << name << ": " << label;
        for (std::size_t m = 0; m < picture.stage.meshes.size(); ++m) {
          const Ends other(picture.outline_of(m));
          if (m == caption.mesh || std::abs(other.bottom - body.bottom) > caption.place.height) continue;
          EXPECT_LT(std::abs(middle_of(caption.place) - body.middle()),
                    std::abs(middle_of(caption.place) - other.middle()))
              << name << ": " << label << " stands rather below " << picture.stage.meshes[m].label;
        }
      }
    }
  }
}

TEST(Captions, OfBodiesThatSlideTowardsTheEyeStandAboveTheirBoards) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  for (const Size size : {Size{640, 360}, Size{1920, 1080}, Size{3840, 2160}}) {
    const LaidOut picture = laid_out(shipped_at("slopes", size));
    ASSERT_EQ(picture.captions.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const PixelRect& place = picture.captions[i].place;
      const Ends block(picture.outline_of(i)), board(picture.outline_of(3 + i));
      EXPECT_LE(place.bottom(), std::min(block.top, board.top));
      EXPECT_GE(place.y, 0);
      EXPECT_TRUE(middle_of(place) > block.left && middle_of(place) < block.right) << "it does not name its block";
      for (std::size_t m = 0; m < 6; ++m) EXPECT_FALSE(overlaps(place, picture.outline_of(m))) << m;
    }
  }
}

// Returns a scene with a cube above the origin at a height [m], and more text.
SceneDef cube_at(double height, const std::string& text) {
  Config config = Config::parse(
      "[[body]]\nname = \"cube\"\nbox = { extent = [0.2, 0.2, 0.2], cells = [1, 1, 1] }\nmaterial = \"rubber\"\n"
      "position = [0, " +
          std::to_string(height) + ", 0]\n" + text,
      "scene.toml", test::assets);
  return read_scene(config);
}

const std::string table =
    "[[collider]]\nname = \"table\"\nshape = { box = { extent = [0.8, 0.1, 0.8] } }\nposition = [0, 0.45, 0]\n";

TEST(Captions, OfABodyOnATableStandBelowTheTable) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  const LaidOut picture = laid_out(cube_at(0.5, table));
  ASSERT_EQ(picture.captions.size(), 1u);
  EXPECT_GE(picture.captions[0].place.y, Ends(picture.outline_of(1)).bottom);
  const LaidOut falling = laid_out(cube_at(0.9, table));
  EXPECT_GE(falling.captions.at(0).place.y, Ends(falling.outline_of(1)).bottom) << "it will come to lie there";
}

TEST(Captions, OfBodiesThatShareAColliderStandBelowThem) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  const std::string other =
      "[[body]]\nname = \"other\"\nbox = { extent = [0.2, 0.2, 0.2], cells = [1, 1, 1] }\nmaterial = \"rubber\"\n"
      "position = [0.25, 0.5, 0]\n";
  const LaidOut picture = laid_out(cube_at(0.5, other + table));
  for (const DrawMesh& mesh : picture.stage.meshes) EXPECT_FALSE(mesh.board);
  EXPECT_EQ(picture.captions.size(), 2u);
}

TEST(Captions, KeepToTheirBodyWhereTheColliderLeavesThePicture) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  const std::string camera = "[camera]\nposition = [0, 1, 2]\ntarget = [0, 0.5, 0]\n";
  const std::string floor =
      "[[collider]]\nname = \"floor\"\nshape = { box = { extent = [20, 2, 20] } }\nposition = [0, -0.5, 0]\n";
  const LaidOut with = laid_out(cube_at(0.5, floor + camera)), without = laid_out(cube_at(0.5, camera));
  ASSERT_EQ(with.captions.size(), 1u);
  EXPECT_TRUE(with.stage.meshes[0].board);
  EXPECT_EQ(with.captions[0].place.y, without.captions[0].place.y);
}

// Returns a camera that has turned around its target.
Camera turned(const Camera& camera, double degrees) {
  Camera result = camera;
  const Eigen::AngleAxisd turn(degrees * M_PI / 180, Vec3::UnitY());
  result.eye = camera.target + turn * (camera.eye - camera.target);
  return result;
}

Camera moved_by(Camera camera, const Vec3& way) {
  camera.eye += way;
  camera.target += way;
  return camera;
}

TEST(Captions, OfTheBodyThatTheCameraFollowsStayInThePicture) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  for (const char* size : {"[output]\nwidth = 640\nheight = 360\n", "[output]\nwidth = 1080\nheight = 1920\n"}) {
    LaidOut picture = laid_out(cube_at(1.5, size));
    picture.stage.camera_moves = true;
    Captions captions(picture.stage);
    const PixelRect first = captions.places(picture.stage.first_camera, Followed{0, Vec3::Zero()}).at(0).place;
    for (const Vec3& way : {Vec3(0, -1.5, 0), Vec3(3, -1, -2), Vec3(0, 4, 0)}) {
      const Camera camera = moved_by(picture.stage.first_camera, way);
      const PixelRect place = captions.places(camera, Followed{0, way}).at(0).place;
      EXPECT_LE(std::abs(place.x - first.x), 1) << way.transpose();
      EXPECT_LE(std::abs(place.y - first.y), 1) << way.transpose();
    }
  }
}

// A body falls to the ground, where its caption waits for it, whichever way the camera goes meanwhile.
TEST(Captions, KeepClearOfAFallenBodyWhereTheCameraMoves) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  LaidOut picture = laid_out(cube_at(1.5, ""));
  picture.stage.camera_moves = true;
  Bounds fallen = picture.stage.meshes[0].rest;
  fallen.lower.y() -= 1.5;
  fallen.upper.y() -= 1.5;
  std::vector<Camera> cameras;
  for (int degrees = 0; degrees < 360; degrees += 15) cameras.push_back(turned(picture.stage.first_camera, degrees));
  for (const double down : {0.5, 1.0}) cameras.push_back(moved_by(picture.stage.first_camera, Vec3(0, -down, 0)));
  Captions captions(picture.stage);
  for (const Camera& camera : cameras) {
    const PixelRect place = captions.places(camera).at(0).place;
    const Outline outline =
        Projection(camera, framed_at_start(picture.stage), picture.stage.width, picture.stage.height).outline(fallen);
    EXPECT_FALSE(overlaps(place, outline)) << camera.eye.transpose();
    EXPECT_LT(place.y - Ends(outline).bottom, 3 * place.height) << "it is far from its body";
  }
}

class CaptionsOfScene : public testing::TestWithParam<std::string> {};

// Neither skins nor models are needed: captions keep clear of the bodies' boxes at the start.
TEST_P(CaptionsOfScene, OverlapNeitherEachOtherNorABodyAtAnySize) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  for (const Size size : {Size{640, 360}, Size{1280, 720}, Size{3840, 2160}, Size{1080, 1920}}) {
    const SceneDef scene = shipped_at(GetParam(), size);
    const LaidOut picture = laid_out(scene);
    Captions captions(picture.stage);
    const auto placed = captions.places(picture.stage.first_camera);
    std::size_t labels = 0;
    for (const BodyDef& body : scene.bodies) labels += scene.look.show_labels && !body.label.empty() ? 1 : 0;
    EXPECT_EQ(placed.size(), labels) << "a caption was left out";
    const PixelRect all = {0, 0, size.width, size.height};
    for (std::size_t i = 0; i < placed.size(); ++i) {
      EXPECT_TRUE(placed[i].place.overlaps(all));
      EXPECT_GE(placed[i].place.x, 0);
      EXPECT_LE(placed[i].place.right(), size.width);
      EXPECT_LE(placed[i].place.bottom(), size.height);
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_FALSE(placed[i].place.overlaps(placed[k].place))
            << scene.bodies[placed[i].mesh].label << " and " << scene.bodies[placed[k].mesh].label;
      EXPECT_FALSE(captions.over_a_body(i)) << scene.bodies[placed[i].mesh].label << " at " << size.width;
    }
  }
}

// Expects that the texts lie in the picture and not over each other.
void expect_apart(const std::vector<PixelRect>& texts, const Size& size) {
  for (std::size_t i = 0; i < texts.size(); ++i) {
    EXPECT_TRUE(texts[i].x >= 0 && texts[i].y >= 0 && texts[i].right() <= size.width &&
                texts[i].bottom() <= size.height)
        << "text " << i << " leaves the picture at " << size.width;
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_FALSE(texts[i].overlaps(texts[k])) << "texts " << k << " and " << i << " at " << size.width;
  }
}

// Graphs find a place beside all other texts that can be switched on, and cost no body its caption.
TEST_P(CaptionsOfScene, LeaveAllOtherTextsFree) {
  const Font font = text_font();
  if (font.empty()) GTEST_SKIP() << "no font is installed";
  for (const Size size : {Size{640, 360}, Size{1280, 720}, Size{3840, 2160}, Size{1080, 1920}}) {
    for (const bool notes : {false, true}) {
      std::vector<std::string> settings = {"output.width=" + std::to_string(size.width),
                                           "output.height=" + std::to_string(size.height), "field.quantity=speed"};
      for (const char* text : {"title", "time", "error_graph", "time_graph"})
        settings.push_back(std::string("text.") + text + "=true");
      for (const char* note : {"method", "milliseconds", "iterations", "error"})
        settings.push_back(std::string("text.") + note + (notes ? "=true" : "=false"));
      const SceneDef scene = load_scene(test::assets / "scenes" / (GetParam() + ".toml"), test::assets, settings);
      const std::vector<Body> bodies = assemble(scene);
      const CollisionSet set = collision_set(scene);
      Stage stage = make_stage(scene, bodies, std::vector<DrawnBody>(bodies.size()), set.scene_colliders,
                               collider_skins(set.scene_colliders, bodies), font);
      stage.field = SurfaceField(scene, bodies).look();
      stage.first_camera = camera_at(scene, stage, 0);
      stage.graphs = graph_looks(scene, 888);
      const OverlayPlaces overlays = overlay_places(stage);
      EXPECT_EQ(overlays.subtitles.width, 0) << "a film without subtitles keeps no room for them";
      EXPECT_EQ(overlays.graphs.size(), 2u) << "there is no room for the graphs at " << size.width;
      std::vector<PixelRect> texts = overlays.all();
      EXPECT_EQ(texts.size(), 4u);
      const std::size_t captioned =
          Captions(stage, {overlays.headline, overlays.legend}).places(stage.first_camera).size();
      Captions captions(stage, texts);
      for (const Captions::Placed& caption : captions.places(stage.first_camera)) texts.push_back(caption.place);
      EXPECT_EQ(texts.size() - 4, captioned) << "the graphs took the place of a caption at " << size.width;
      expect_apart(texts, size);
    }
  }
}

// Captions keep clear of subtitles where they can stay beside their bodies; elsewhere they are where they would be
// without, and those that a subtitle covers are not drawn below it.
TEST_P(CaptionsOfScene, LeaveSubtitlesTheirPlace) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  for (const Size size : {Size{640, 360}, Size{1920, 1080}, Size{1080, 1920}}) {
    LaidOut picture = laid_out(shipped_at(GetParam(), size));
    picture.stage.subtitles = {"What is said here has a line of usual length"};
    const OverlayPlaces overlays = overlay_places(picture.stage);
    ASSERT_GT(overlays.subtitles.width, 0);
    Captions captions(picture.stage, overlays.all(), overlays.subtitles);
    const std::vector<Captions::Placed> placed = captions.places(picture.stage.first_camera);
    ASSERT_EQ(placed.size(), picture.captions.size()) << "a caption was left out at " << size.width;
    bool clear = true, as_without = true;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const PixelRect &place = placed[i].place, &without = picture.captions[i].place;
      clear &= !place.overlaps(overlays.subtitles);
      as_without &= place.x == without.x && place.y == without.y && place.height == without.height;
    }
    EXPECT_TRUE(clear || as_without) << size.width;
    const std::size_t pixels = std::size_t(size.width) * std::size_t(size.height);
    Image image{size.width, size.height, std::vector<std::uint8_t>(3 * pixels, 128)}, covered = image;
    DrawList list;
    list.camera = picture.stage.first_camera;
    captions.draw(image, list);
    captions.draw(covered, list, {0, 0, size.width, size.height});
    EXPECT_EQ(std::ranges::any_of(image.rgb, [](int value) { return value != 128; }), !placed.empty());
    EXPECT_TRUE(std::ranges::all_of(covered.rgb, [](int value) { return value == 128; }));
  }
}

// Returns the places of a scene's legend and captions, with a legend that shows speeds.
std::vector<PixelRect> texts_with_legend(const SceneDef& scene, const std::vector<Body>& bodies, Stage& stage) {
  const CollisionSet set = collision_set(scene);
  stage = make_stage(scene, bodies, std::vector<DrawnBody>(bodies.size()), set.scene_colliders,
                     collider_skins(set.scene_colliders, bodies), text_font());
  stage.field = SurfaceField(scene, bodies).look();
  stage.kept_free = legend_room(stage);
  stage.first_camera = camera_at(scene, stage, 0);
  std::vector<PixelRect> texts = overlay_places(stage).all();
  Captions captions(stage, texts);
  for (const Captions::Placed& caption : captions.places(stage.first_camera)) texts.push_back(caption.place);
  return texts;
}

// A legend costs no body its caption: cameras that frame the bodies leave room for it. Only where eleven captions with
// notes stand side by side, 640 pixels are too few for them.
TEST_P(CaptionsOfScene, AllStayBesideALegend) {
  if (text_font().empty()) GTEST_SKIP() << "no font is installed";
  const std::filesystem::path file = test::assets / "scenes" / (GetParam() + ".toml");
  const std::vector<Body> bodies = assemble(load_scene(file, test::assets, {}));
  for (const Size size : {Size{640, 360}, Size{1280, 720}, Size{3840, 2160}}) {
    for (const bool notes : {false, true}) {
      if (notes && size.width == 640 && bodies.size() > 10) continue;
      std::vector<std::string> settings = {"output.width=" + std::to_string(size.width),
                                           "output.height=" + std::to_string(size.height), "field.quantity=speed"};
      for (const char* note : {"method", "milliseconds", "iterations", "error"})
        settings.push_back(std::string("text.") + note + (notes ? "=true" : "=false"));
      Stage stage;
      const std::vector<PixelRect> texts = texts_with_legend(load_scene(file, test::assets, settings), bodies, stage);
      EXPECT_EQ(texts.size(), 1 + Captions(stage).places(stage.first_camera).size())
          << "the legend took the place of a caption at " << size.width << " with notes: " << notes;
      expect_apart(texts, size);
    }
  }
}

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(test::assets / "scenes"))
    names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Shipped, CaptionsOfScene, testing::ValuesIn(shipped_scenes()), [](const auto& one) {
  std::string name = one.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(Captions, ABodyThatIsAloneAndHasNoNameHasNone) {
  const auto label_of = [](const std::string& text) {
    Config config =
        Config::parse("[[body]]\nbox = { extent = [1, 1, 1], cells = [1, 1, 1] }\nmaterial = \"rubber\"\n" + text,
                      "scene.toml", test::assets);
    return read_scene(config).bodies.front().label;
  };
  EXPECT_EQ(label_of(""), "");
  EXPECT_EQ(label_of("name = \"cube\"\n"), "cube");
  EXPECT_EQ(label_of("label = \"soft\"\n"), "soft");
}

}  // namespace caption_layout_test
}  // namespace supple
