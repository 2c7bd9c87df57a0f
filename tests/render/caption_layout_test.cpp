// Tests where captions stand: below their bodies, over no other caption, and over no body, in all scenes that ship and
// at three sizes of the picture.
#include "render/caption_layout.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/convex_hull.h"
#include "film/camera.h"
#include "film/draw_scene.h"
#include "film/film_graphs.h"
#include "film/places.h"
#include "film/surface_field.h"
#include "render/captions.h"
#include "render/legend.h"
#include "render/overlays.h"
#include "scene/scene_reader.h"
#include "support/bodies.h"

namespace supple {
namespace {

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
  const auto places = caption_places({{{150, 150}, 40, 10}, {{150, 150}, 40, 10}}, {square}, {}, 400, 300);
  ASSERT_TRUE(places);
  EXPECT_FALSE((*places)[0].overlaps((*places)[1]));
  for (const PixelRect& place : *places) EXPECT_FALSE(overlaps(place, square));
  EXPECT_FALSE(caption_places({{{150, 150}, 40, 10}}, {square}, {}, 400, 205)) << "there is no room below";
  EXPECT_FALSE(caption_places({{{150, 150}, 500, 10}}, {}, {}, 400, 300)) << "it is wider than the picture";
}

struct Size {
  int width, height;
};

class CaptionsOfScene : public testing::TestWithParam<std::string> {};

// Neither skins nor models are needed: captions keep clear of the bodies' boxes at the start.
TEST_P(CaptionsOfScene, OverlapNeitherEachOtherNorABodyAtAnySize) {
  const std::string font = caption_font();
  if (font.empty()) GTEST_SKIP() << "no font is installed";
  for (const Size size : {Size{640, 360}, Size{1280, 720}, Size{3840, 2160}}) {
    const SceneDef scene =
        load_scene(test::assets / "scenes" / (GetParam() + ".toml"), test::assets,
                   {"output.width=" + std::to_string(size.width), "output.height=" + std::to_string(size.height)});
    const std::vector<Body> bodies = assemble(scene);
    const CollisionSet set = collision_set(scene);
    const Stage stage = make_stage(scene, bodies, std::vector<DrawnBody>(bodies.size()), set.obstacles,
                                   collider_skins(set.obstacles, bodies), font);
    Captions captions(stage);
    const auto placed = captions.places(camera_at(scene, stage, 0));
    std::size_t labels = 0;
    for (const BodyDef& body : scene.bodies) labels += scene.look.show_labels && !body.label.empty() ? 1 : 0;
    EXPECT_EQ(placed.size(), labels) << "a caption was left out";
    const PixelRect picture = {0, 0, size.width, size.height};
    for (std::size_t i = 0; i < placed.size(); ++i) {
      EXPECT_TRUE(placed[i].place.overlaps(picture));
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
  const std::string font = caption_font();
  if (font.empty()) GTEST_SKIP() << "no font is installed";
  for (const Size size : {Size{640, 360}, Size{1280, 720}, Size{3840, 2160}}) {
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
      Stage stage = make_stage(scene, bodies, std::vector<DrawnBody>(bodies.size()), set.obstacles,
                               collider_skins(set.obstacles, bodies), font);
      stage.field = SurfaceField(scene, bodies).look();
      stage.first_camera = camera_at(scene, stage, 0);
      stage.graphs = graph_looks(scene, 888);
      const OverlayPlaces overlays = overlay_places(stage);
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

// Returns the places of a scene's legend and captions, with a legend that shows speeds.
std::vector<PixelRect> texts_with_legend(const SceneDef& scene, const std::vector<Body>& bodies, Stage& stage) {
  const CollisionSet set = collision_set(scene);
  stage = make_stage(scene, bodies, std::vector<DrawnBody>(bodies.size()), set.obstacles,
                     collider_skins(set.obstacles, bodies), caption_font());
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
  if (caption_font().empty()) GTEST_SKIP() << "no font is installed";
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

}  // namespace
}  // namespace supple
