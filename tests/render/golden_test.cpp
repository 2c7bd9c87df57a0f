// Pictures against stored ones. A software rasteriser's rounding differs between machines and Mesa versions by a few
// levels along edges; a missing shadow, a wrong colour or a body in the wrong place differs by far more over whole
// regions. So small pictures are compared by their mean difference and by the share of pixels that are clearly off. A
// failing test leaves its candidate in the build folder.
#include <gtest/gtest.h>

#include "film/draw_scene.h"
#include "film/places.h"
#include "output/png_file.h"
#include "render/renderer.h"
#include "scene/scene_reader.h"
#include "support/bodies.h"

namespace supple {
namespace {

constexpr double mean_allowed = 1.5;     // of 255
constexpr double pixels_allowed = 0.01;  // share that differs by more than 24 in some channel

Image rest_picture(const std::vector<std::string>& settings, GlChoice gl) {
  std::vector<std::string> all = {"output.width=320", "output.height=180", "look.labels=false"};
  all.insert(all.end(), settings.begin(), settings.end());
  const SceneDef scene = load_scene(test::assets / "scenes" / "squirrel.toml", test::assets, all);
  const std::vector<Body> bodies = assemble(scene);
  std::vector<DrawnBody> drawn;
  DrawList list;
  for (const Body& body : bodies) {
    drawn.push_back(drawn_body(scene, body));
    const Model model = build_model(body.description);
    list.positions.push_back(skin_positions(drawn.back(), model, rest_state(model)));
  }
  const Stage stage = make_stage(scene, bodies, drawn, {}, {}, "");
  list.camera = make_camera(scene, stage);
  Renderer renderer(stage, gl, test::source_folder / "shaders");
  return renderer.draw(list);
}

void expect_golden(const std::string& name, const Image& image) {
  const std::filesystem::path golden = test::source_folder / "tests" / "golden" / (name + ".png");
  const std::filesystem::path candidate = std::filesystem::path(SUPPLE_BUILD_FOLDER) / (name + "-candidate.png");
  write_png(candidate, image.width, image.height, image.rgb);
  ASSERT_TRUE(std::filesystem::exists(golden)) << "no stored picture; the candidate is " << candidate;
  const PngImage expected = read_png(golden);
  ASSERT_EQ(expected.rgb.size(), image.rgb.size());
  double sum = 0;
  std::size_t off = 0;
  for (std::size_t pixel = 0; pixel < image.rgb.size(); pixel += 3) {
    int worst = 0;
    for (int k = 0; k < 3; ++k) {
      const int difference = std::abs(int(image.rgb[pixel + k]) - int(expected.rgb[pixel + k]));
      sum += difference;
      worst = std::max(worst, difference);
    }
    off += worst > 24 ? 1 : 0;
  }
  EXPECT_LT(sum / static_cast<double>(image.rgb.size()), mean_allowed) << candidate;
  EXPECT_LT(static_cast<double>(off) / static_cast<double>(image.rgb.size() / 3), pixels_allowed) << candidate;
  if (!testing::Test::HasFailure()) std::filesystem::remove(candidate);
}

TEST(Golden, ThreeSquirrelsAtRest) { expect_golden("squirrels", rest_picture({}, GlChoice::osmesa)); }

TEST(Golden, EglGivesThePictureOfOsmesa) {
  try {
    expect_golden("squirrels", rest_picture({}, GlChoice::egl));
  } catch (const RunError& error) {
    GTEST_SKIP() << error.what();  // a machine may have one of the two only
  }
}

}  // namespace
}  // namespace supple
