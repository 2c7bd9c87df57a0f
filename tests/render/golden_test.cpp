// Compares pictures with stored ones. A software rasteriser's rounding differs between machines and Mesa versions by a
// few levels along edges; a missing shadow, a wrong colour or a body in the wrong place differs by far more over whole
// regions. So small pictures are compared by their mean difference and by the share of pixels that are clearly off. A
// failing test leaves its candidate in the build folder: look at it, and copy it to tests/golden/ when it is right.
//
// A stored picture is of use only if it tells when the thing that it shows is missing. So each test also draws its
// scene with that thing removed, and expects a difference beyond the tolerance.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <span>

#include "base/motion_hull.h"
#include "film/pictures/drawn_film.h"
#include "film/redraw/split_screen.h"
#include "output/files/obj_file.h"
#include "output/files/png_file.h"
#include "output/motion/point_cache.h"
#include "output/run/run_folder.h"
#include "render/font_search.h"
#include "render/renderer.h"
#include "sim/measures/fields.h"
#include "support/colored_files.h"
#include "support/film.h"
#include "support/places.h"

namespace supple {
namespace golden_test {

constexpr double mean_allowed = 1.5;     // of 255
constexpr int clearly_off = 24;          // of 255, in some channel
constexpr double pixels_allowed = 0.01;  // share of those that are clearly off
constexpr double least_noticed = 0.05;   // of 255: the mean that a small feature makes at least

const std::filesystem::path golden_folder = test::source_folder / "tests" / "golden";

// This is the font of the stored captions; other fonts have other letters.
const std::string lato = "/usr/share/fonts/truetype/lato/Lato-Regular.ttf";

using Settings = std::vector<std::string>;

// Describes what to draw: a scene, changed by settings in the form that --set takes. Bodies stay where they start,
// which is the same on all machines, or move for a few frames, in which rounding errors do not grow to a visible size.
struct Shot {
  std::filesystem::path scene;
  Settings settings = {};
  int frames = 0;                   // that pass before the picture is taken
  std::string font = {};            // a file; without it there are no words
  std::vector<FrameRow> rows = {};  // of the run's profile, the last one being the picture's
  Bounds motion = {};               // of the whole film, for cameras that frame it
};

// Describes how something that a shot shows is removed: by settings, or on the stage where no setting does it.
struct Removal {
  Settings settings = {};
  std::function<void(Stage&)> on_stage = {};
  bool small = false;  // it shows in fewer pixels than machines may differ in: it must only be seen here
};

std::filesystem::path shipped(const std::string& scene) { return test::assets / "scenes" / (scene + ".toml"); }
std::filesystem::path written_for_tests(const std::string& scene) { return golden_folder / (scene + ".toml"); }

struct Picture {
  Stage stage;
  DrawList list;
};

// Makes a picture in the same way as a film. No other function of these tests depends on how a film does that.
Picture picture_of(const Shot& shot, const Settings& more = {}) {
  Settings settings = {"output.width=320", "output.height=180"};
  settings.insert(settings.end(), shot.settings.begin(), shot.settings.end());
  settings.insert(settings.end(), more.begin(), more.end());
  const test::Film film(shot.scene, settings);
  const Script script = Script::load(shot.scene, test::assets, settings);
  const DrawnAs surface = film.scene.look.wireframe ? DrawnAs::elements : DrawnAs::skin;
  DrawnFilm drawn(script, film.bodies, drawn_bodies(film.bodies, {}, surface), film.set, Font{shot.font, 0});
  drawn.know_times(shot.rows);
  std::vector<Positions> motion, before, forces(film.bodies.size());
  for (const Body& body : film.bodies) motion.push_back(first_positions(body));
  before = motion;
  film.play(1, shot.frames,
            [&](std::size_t b, int, const State& from, const StepInputs&, const State& to, const OpenWorkspace& w) {
              before[b] = in_input_order(film.models[b], from.x);
              motion[b] = in_input_order(film.models[b], to.x);
              forces[b] = contact_forces(film.models[b], w, to.x);
            });
  if (film.scene.camera.frames == Framed::film) drawn.frame_motion(corners_of(shot.motion));
  FramePose pose{shot.frames - 1, film.scene.fps.time_of(shot.frames), {}, {}};
  for (const Positions& body : motion) pose.motion.push_back(&body);
  for (const Positions& body : before) pose.before.push_back(&body);
  for (const Positions& body : forces) pose.forces.push_back(&body);
  if (!shot.rows.empty()) pose.row = &shot.rows.back();
  std::vector<GraphPoint> earlier;
  for (std::size_t f = 0; f + 1 < shot.rows.size(); ++f) earlier.push_back(graph_point(shot.rows[f]));
  pose.earlier = earlier;
  Threads threads(1);
  return {drawn.stage(), drawn.list(film.scene, pose, film.set, threads)};
}

Image draw(const Picture& picture, GlChoice gl = GlChoice::osmesa) {
  Renderer renderer(picture.stage, gl, test::source_folder / "shaders");
  return renderer.draw(picture.list);
}

struct Difference {
  double mean;    // of all channels, of 255
  double pixels;  // share of pixels that are clearly off
  bool allowed() const { return mean < mean_allowed && pixels < pixels_allowed; }
};

std::ostream& operator<<(std::ostream& out, const Difference& difference) {
  return out << "a mean difference of " << difference.mean << " of 255, " << 100 * difference.pixels
             << " % of the pixels clearly off";
}

Difference difference_of(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0;
  std::size_t off = 0;
  for (std::size_t pixel = 0; pixel < a.size(); pixel += 3) {
    int worst = 0;
    for (std::size_t k = pixel; k < pixel + 3; ++k) {
      const int difference = std::abs(int(a[k]) - int(b[k]));
      sum += difference;
      worst = std::max(worst, difference);
    }
    off += worst > clearly_off ? 1 : 0;
  }
  const auto channels = static_cast<double>(a.size());
  return {sum / channels, 3 * static_cast<double>(off) / channels};
}

void expect_golden(const std::string& name, const Image& image) {
  const std::filesystem::path golden = golden_folder / (name + ".png");
  const std::filesystem::path candidate = test::build_folder / (name + "-candidate.png");
  write_png(candidate, image.width, image.height, image.rgb);
  ASSERT_TRUE(std::filesystem::exists(golden)) << "no stored picture; the candidate is " << candidate;
  const PngImage expected = read_png(golden);
  ASSERT_EQ(expected.width, image.width);
  ASSERT_EQ(expected.height, image.height);
  const Difference difference = difference_of(expected.rgb, image.rgb);
  EXPECT_TRUE(difference.allowed()) << difference << "; the candidate is " << candidate;
  if (difference.allowed()) std::filesystem::remove(candidate);
}

// Checks that the shot is as it was stored, and that each removal would have been noticed.
void expect_golden(const std::string& name, const Shot& shot, const std::vector<Removal>& removals) {
  const Picture picture = picture_of(shot);
  const Image image = draw(picture);
  expect_golden(name, image);
  for (std::size_t i = 0; i < removals.size(); ++i) {
    Picture rest = removals[i].settings.empty() ? picture : picture_of(shot, removals[i].settings);
    if (removals[i].on_stage) removals[i].on_stage(rest.stage);
    const Difference difference = difference_of(image.rgb, draw(rest).rgb);
    const bool noticed = removals[i].small ? difference.mean > least_noticed : !difference.allowed();
    EXPECT_TRUE(noticed) << "nobody would notice removal " << i << ", which makes only " << difference;
  }
}

void draw_one_side(Stage& stage) {
  for (DrawMesh& mesh : stage.meshes) mesh.two_sided = false;
}

void remove_hem(Stage& stage) {
  for (DrawMesh& mesh : stage.meshes)
    if (mesh.cloth) mesh.cloth->hem = 0;
}

void remove_paint(Stage& stage) {
  for (DrawMesh& mesh : stage.meshes) mesh.layers.clear();
}

const Shot squirrels = {shipped("squirrel"), {"look.labels=false"}};

TEST(Golden, ThreeSquirrelsAtRest) { expect_golden("squirrels", squirrels, {{.on_stage = remove_paint}}); }

// A picture far from the stage's place, with all that it shows, is the picture that it was at that place. When only the
// light moves after the bodies by a part of its radius, the ground differs by a level or two.
TEST(Golden, WhatLeavesItsPlaceKeepsItsPicture) {
  const Picture here = picture_of(squirrels);
  const Image expected = draw(here);
  for (const Vec3& moved : {Vec3(1.5, 0, 0), Vec3(-12, 0, 5)}) {
    Picture there = here;
    for (std::vector<float>& points : there.list.positions) {
      for (std::size_t i = 0; i < points.size(); ++i) points[i] += static_cast<float>(moved[Eigen::Index(i % 3)]);
    }
    there.list.camera.eye += moved;
    there.list.camera.target += moved;
    there.list.followed = Followed{0, moved};
    const Difference difference = difference_of(expected.rgb, draw(there).rgb);
    EXPECT_LT(difference.mean, 1.5) << moved.transpose();
    EXPECT_LT(difference.pixels, 0.02) << moved.transpose();
  }
}

TEST(Golden, EglGivesThePictureOfOsmesa) {
  try {
    expect_golden("squirrels", draw(picture_of(squirrels), GlChoice::egl));
  } catch (const RunError& error) {
    GTEST_SKIP() << error.what();  // a machine may have one of the two only
  }
}

TEST(Golden, ClothShowsBothItsSides) {
  expect_golden("cloth", {written_for_tests("cloth")},
                {{.on_stage = draw_one_side},
                 {{"body.front.pattern=none", "body.back.pattern=none"}},
                 {.settings = {"body.back.back_color=[0.62, 0.76, 0.90]"}},
                 {.on_stage = remove_hem, .small = true}});
}

TEST(Golden, CollidersStandAroundABody) {
  expect_golden("colliders", {written_for_tests("colliders")},
                {{{"collider.ring.visible=false"}},
                 {{"collider.ring.keys=[]"}},
                 {{"collider.stairs.visible=false"}},
                 {{"collider.wall.visible=false"}}});
}

TEST(Golden, PatternsArePrintedOnBodies) {
  expect_golden(
      "pattern", {written_for_tests("pattern")},
      {{{"body.twisted.pattern=none"}}, {{"body.stretched.pattern=none"}}, {{"body.stretched.pattern=grid"}}});
}

TEST(Golden, CaptionsStandBelowTheirBodies) {
  if (!std::filesystem::exists(lato)) GTEST_SKIP() << lato << " is not installed";
  expect_golden("captions", {written_for_tests("captions"), {}, 0, lato}, {{{"look.labels=false"}}});
}

TEST(Golden, ARegionIsHeldAndPainted) {
  expect_golden("regions", {written_for_tests("regions")},
                {{.on_stage = remove_paint}, {{"body.bar.handles.middle.select={ box = [[0, 0, 0], [0.1, 1, 1]] }"}}});
}

// The left ball starts flat and the right one tall; these are the deformations that their materials resist.
TEST(Golden, BallsOfSplineMaterialsComeBack) {
  expect_golden("spline",
                {shipped("spline-spheres"),
                 {"look.labels=false", "body.a.start.stretch=[1.3, 0.4, 1.3]", "body.b.start.stretch=[0.7, 1.6, 0.7]",
                  "camera.position=[0, 2.6, 7.2]", "camera.target=[0, 1.55, 0]"},
                 3},
                {{{"body.a.material={ model = 'neo-hookean', mu = 250, lambda = 250 }"}},
                 {{"body.b.material={ model = 'neo-hookean', mu = 250, lambda = 250 }"}}});
}

TEST(Golden, ABodyIsDrawnByTheSurfaceOfItsFile) {
  expect_golden(
      "surface", {written_for_tests("surface")},
      {{{"body.steps.box={ extent = [1.4, 0.9, 2.1], cells = [6, 4, 9] }"}}, {{"body.steps.start.twist_deg=0"}}});
}

// The bar is stretched to 1.5 of its length in the middle of the range; the cloth beside it has no stress.
TEST(Golden, AFieldIsShownInColoursWithItsLegend) {
  const std::string font = std::filesystem::exists(lato) ? lato : "";
  if (font.empty()) GTEST_SKIP() << lato << " is not installed";
  const Shot stretch = {written_for_tests("field"), {"field.quantity=stretch"}, 0, font};
  expect_golden("field-stretch", stretch,
                {{{"field.quantity=none"}}, {{"field.legend=false"}}, {{"field.colors=blue-yellow"}}});
  EXPECT_EQ(draw(picture_of(stretch)).rgb, draw(picture_of(stretch, {"body.bar.pattern=none"})).rgb)
      << "the lines of the print are seen among the colours";
  const auto with = [&stretch](std::vector<std::string> settings, int frames = 0) {
    Shot shot = stretch;
    shot.settings = std::move(settings);
    shot.frames = frames;
    return shot;
  };
  const Removal none = {{"field.quantity=none"}};
  expect_golden("field-compression", with({"field.quantity=compression"}), {none});
  expect_golden("field-volume", with({"field.quantity=volume"}), {none, {{"field.colors=viridis"}}});
  expect_golden("field-energy", with({"field.quantity=energy", "field.range=[0, 1e4]"}),
                {none, {{"field.range=[0, 1e6]"}}});
  expect_golden("field-stress", with({"field.quantity=stress", "field.range=[0, 4e4]"}), {none});
  expect_golden("field-speed", with({"field.quantity=speed", "field.range=[0, 0.5]"}, 3), {none});
  expect_golden("field-depth",
                with({"field.quantity=depth", "field.range=[0, 0.15]", "collider.ground.thickness=0.15"}), {none});
  expect_golden("field-force",
                with({"field.quantity=force", "field.range=[0, 2e4]", "look.backdrop=plain",
                      "collider.ground.visible=false", "camera.position=[0.8, -2, 3.4]"},
                     2),
                {none, {{"collider.ground.position=[0, -1, 0]"}, {}, true}});
}

// The reference is a run in which nothing has moved, so that the colours show how far each body was deformed.
TEST(Golden, TheDistanceToAnotherRunIsShownInColours) {
  const test::TemporaryFolder run;
  std::filesystem::create_directories(run.path / "motion");
  std::ofstream(run.path / "run.json") << R"({"scene": {}})";
  const test::Film film(written_for_tests("field"), {});
  for (const Body& body : film.bodies) {
    const Positions& rest = body.description.mesh.rest;
    PointCacheWriter(run.path / "motion" / (body.def.name + ".pc2"), int(rest.rows()))
        .add(rest.rowwise() - motion_origin(rest).transpose());
  }
  expect_golden("field-distance",
                {written_for_tests("field"),
                 {"field.quantity=distance", "field.range=[0, 0.3]", "field.reference=" + run.path.string()},
                 1},
                {{{"field.quantity=none", "field.reference="}}});
}

TEST(Golden, AWireframeShowsTheElementsOverAField) {
  expect_golden("wireframe", {written_for_tests("field"), {"look.wireframe=true"}}, {{{"look.wireframe=false"}}});
}

TEST(Golden, MarksShowHandlesAndContacts) {
  expect_golden("marks", {written_for_tests("field"), {"look.marks=true"}}, {{{"look.marks=false"}, {}, true}});
}

TEST(Golden, SupportsAreSeenWhereHandlesHold) {
  const Shot shot = {written_for_tests("supports")};
  const Removal without = {{"look.supports=false"}, {}, true};
  expect_golden("supports", shot, {without});
  Picture picture = picture_of(shot);
  const auto supports = std::ranges::count_if(picture.stage.meshes, [](const DrawMesh& mesh) { return !mesh.framed; });
  EXPECT_EQ(supports, 5);
  EXPECT_EQ(picture.list.positions.size(), picture.stage.meshes.size());

  // The camera frames the same without them.
  const Picture bare = picture_of(shot, without.settings);
  EXPECT_EQ(bare.stage.meshes.size() + 5, picture.stage.meshes.size());
  EXPECT_EQ(bare.list.camera.eye, picture.list.camera.eye);
}

// They go along with what is held, and are seen only while the handle holds.
TEST(Golden, SupportsMoveWithTheirHandlesAndGoWithThem) {
  const Shot moved = {written_for_tests("supports"), {"body.bar.handles.end.keys=[{ t = 0, move = [0, 0.2, 0] }]"}, 1};
  const Picture still = picture_of({moved.scene, {}, 1}), up = picture_of(moved);
  const std::size_t plate = 4;  // after the four bodies
  ASSERT_FALSE(still.stage.meshes[plate].framed);
  ASSERT_EQ(still.list.positions[plate].size(), up.list.positions[plate].size());
  for (std::size_t i = 0; i < still.list.positions[plate].size(); ++i)
    EXPECT_NEAR(up.list.positions[plate][i] - still.list.positions[plate][i], i % 3 == 1 ? 0.2 : 0, 1e-5);

  const std::vector<std::string> free = {"body.bar.handles.end.stiffness=1e3", "body.bar.handles.end.from=0.5"};
  std::vector<std::string> bare = free;
  bare.emplace_back("look.supports=false");
  const Shot bar_alone = {written_for_tests("supports-of-one")};
  EXPECT_NE(draw(picture_of(bar_alone)).rgb, draw(picture_of(bar_alone, {"look.supports=false"})).rgb);
  EXPECT_EQ(draw(picture_of(bar_alone, free)).rgb, draw(picture_of(bar_alone, bare)).rgb);
}

TEST(Golden, AGhostOfAnotherRunIsSeenThroughTheBodies) {
  const test::TemporaryFolder run;
  std::filesystem::create_directories(run.path / "motion");
  std::ofstream(run.path / "run.json") << R"({"scene": {}})";
  const test::Film film(written_for_tests("field"), {});
  for (const Body& body : film.bodies) {
    const Positions& rest = body.description.mesh.rest;
    const Positions moved = rest.rowwise() + (Vec3(0.1, 0.15, 0.1) - motion_origin(rest)).transpose();
    PointCacheWriter(run.path / "motion" / (body.def.name + ".pc2"), int(rest.rows())).add(moved);
  }
  expect_golden("ghost", {written_for_tests("field"), {"look.ghost=" + run.path.string()}, 1}, {{{"look.ghost="}}});
}

TEST(Golden, EachSetOfLampsHasItsOwnMood) {
  const Removal studio = {{"look.light=studio"}};
  for (const char* light : {"sunset", "overcast", "dark"})
    expect_golden(std::string("light-") + light, {written_for_tests("field"), {std::string("look.light=") + light}},
                  {studio});
}

TEST(Golden, TheGroundCanBeLeftOut) {
  expect_golden("plain", {written_for_tests("field"), {"look.backdrop=plain", "body.ball.gloss=0.9"}},
                {{{"look.backdrop=ground"}}, {{"body.ball.gloss=0"}, {}, true}});
}

TEST(Golden, LightComesThroughThinThingsAndShinesOnWetOnes) {
  expect_golden("finish", {written_for_tests("finish")},
                {{{"body.rabbit.translucent=0"}, {}, true},
                 {{"body.cube.translucent=0"}, {}, true},
                 {{"body.sheet.translucent=0"}},
                 {{"body.rabbit.roughness=1"}, {}, true},
                 {{"collider.ball.roughness=1"}, {}, true}});
}

TEST(Golden, WordsTellOfTheFilmAndItsBodies) {
  if (!std::filesystem::exists(lato)) GTEST_SKIP() << lato << " is not installed";
  expect_golden("words",
                {written_for_tests("captions"), {"text.title=true", "text.time=true", "text.method=true"}, 0, lato},
                {{{"text.title=false", "text.time=false"}, {}, true}, {{"text.method=false"}, {}, true}});
}

// A subtitle is read on a white picture as on a dark one, wide or narrow.
TEST(Golden, SubtitlesStandAtTheLowerEdge) {
  if (!std::filesystem::exists(lato)) GTEST_SKIP() << lato << " is not installed";
  const std::string subtitles =
      "text.subtitles=[{ from = 0, to = 1, text = 'A line that is long enough for narrow pictures to break it' }]";
  const Removal without = {{"text.subtitles=[]"}};
  expect_golden(
      "subtitles",
      {written_for_tests("captions"), {subtitles, "look.ground=[1, 1, 1]", "look.background=[1, 1, 1]"}, 1, lato},
      {without});
  expect_golden("subtitles-narrow",
                {written_for_tests("captions"),
                 {subtitles, "output.width=180", "output.height=320", "look.light=dark", "look.ground=[0.1, 0.1, 0.1]",
                  "look.background=[0.1, 0.1, 0.1]"},
                 1,
                 lato},
                {without});
}

// Greek comes from the font itself, Hebrew and Arabic from another one.
TEST(Golden, WordsMayBeInAnyScript) {
  const auto other = font_with(U'\u0633');
  if (!std::filesystem::exists(lato) || !other || !other->file.ends_with("DejaVuSans.ttf") ||
      font_with(U'\u05e9') != other)
    GTEST_SKIP() << "the stored picture has letters of Lato and DejaVu Sans";
  expect_golden("scripts",
                {written_for_tests("captions"),
                 {"body.a.label='\u0395\u03bb\u03bb\u03b7\u03bd\u03b9\u03ba\u03ac'",
                  "body.b.label='\u05e9\u05dc\u05d5\u05dd 40 kPa'",
                  "body.c.label='\u0645\u0637\u0627\u0637 \u0646\u0627\u0639\u0645'"},
                 0,
                 lato},
                {{{"look.labels=false"}}, {{"body.c.label=''"}, {}, true}});
}

TEST(Golden, SmallGraphsStandInACorner) {
  if (!std::filesystem::exists(lato)) GTEST_SKIP() << lato << " is not installed";
  std::vector<FrameRow> rows(25);
  for (std::size_t f = 0; f < rows.size(); ++f) {
    rows[f].step_ms = 12 + 6 * std::sin(0.7 * static_cast<double>(f));
    rows[f].bodies.resize(1);
    rows[f].bodies[0].error_estimate = std::pow(10, -2.5 - 1.5 * std::cos(0.3 * static_cast<double>(f)));
    rows[f].bodies[0].error_measured = f % 6 == 0;
    rows[f].bodies[0].error = 1e-4;
  }
  const Shot shot = {written_for_tests("field"),
                     {"text.error_graph=true", "text.time_graph=true", "text.title=true", "frames=40"},
                     0,
                     lato,
                     rows};
  expect_golden("graphs", shot,
                {{{"text.error_graph=false"}}, {{"text.time_graph=false"}}, {{"frames=400"}, {}, true}});
}

// The pictures are taken after three frames, a tenth of a second; without a position, the ball and what is beside it
// are framed.
TEST(Golden, EachKindOfCameraStandsWhereItShould) {
  const test::TemporaryFolder folder;
  const std::string text = test::read_file(written_for_tests("field"));
  test::write_text(folder.path / "field.toml", text.substr(0, text.find("[camera]")));
  const auto with = [&folder](std::vector<std::string> settings) {
    return Shot{folder.path / "field.toml", std::move(settings), 3};
  };
  expect_golden("camera-usual", with({}), {{{"camera.azimuth=45"}}, {{"camera.elevation=25"}}});
  expect_golden("camera-direction",
                with({"camera.azimuth=-50", "camera.elevation=35", "camera.distance=3.5", "camera.fov_deg=40"}),
                {{{"camera.azimuth=30"}}, {{"camera.elevation=14"}}, {{"camera.distance=5"}}, {{"camera.fov_deg=30"}}});
  expect_golden("camera-place", with({"camera.position=[0.8, 1, 3]"}), {{{"camera.target=[0, 0, 0]"}}});
  expect_golden("camera-orbit", with({"camera.orbit=600"}), {{{"camera.orbit=0"}}});
  expect_golden("camera-follow", with({"camera.follow=sheet", "camera.distance=2.5"}), {{{"camera.follow=ball"}}});
  const std::string keys =
      "camera.keys=[{ t = 0, azimuth = 0, elevation = 5 }, { t = 0.2, azimuth = 120, distance = 3 }]";
  expect_golden("camera-keys", with({keys}), {{{"camera.keys=[]"}}, {{"camera.ease=linear", "camera.keys=[]"}}});
  Shot film = with({"camera.frames=film"});
  film.motion.include(Vec3(-2, 0, -1));
  film.motion.include(Vec3(1, 2, 1));
  expect_golden("camera-film", film, {{{"camera.frames=start"}}});
}

TEST(Golden, PanelsStandInEveryLayoutWithTheLegendBesideThem) {
  if (!std::filesystem::exists(lato)) GTEST_SKIP() << lato << " is not installed";
  const test::TemporaryFolder folder;
  Picture picture = picture_of(
      {written_for_tests("field"), {"field.quantity=stretch", "output.width=160", "output.height=120"}, 0, lato});
  SplitScreen screen{{}, 1, {lato, 0}, picture.stage.field};
  picture.stage.field->title.clear();
  const Image panel = draw(picture);
  FrameRow row;
  row.step_ms = 12.3;
  row.bodies.resize(1);
  row.bodies[0].iterations = 10;
  row.bodies[0].error_estimate = 2.5e-4;
  for (const char* name : {"ours", "one Newton iteration", "Projective Dynamics"}) {
    const std::filesystem::path frames = folder.path / name;
    std::filesystem::create_directory(frames);
    write_png(picture_file(frames, 0), panel.width, panel.height, panel.rgb);
    screen.panels.push_back({frames, name, {row}});
  }
  for (const Layout layout : {Layout::row, Layout::column, Layout::grid}) {
    screen.columns = columns_of(layout, 3);
    const Image image = split_picture(screen, 0, 0);
    expect_golden("split-" + std::string(name_of(layout)), image);
    SplitScreen bare = screen;
    bare.panels[1].name.clear();
    EXPECT_GT(difference_of(image.rgb, split_picture(bare, 0, 0).rgb).mean, least_noticed) << "a name is not seen";
    bare.legend.reset();
    EXPECT_LT(split_picture(bare, 0, 0).width, image.width) << "the legend takes no room";
  }
}

void remove_file_colors(Stage& stage) {
  for (DrawMesh& mesh : stage.meshes) mesh.surface_colors.clear();
}

void flip_textures(Stage& stage) {
  for (DrawMesh& mesh : stage.meshes)
    for (SurfaceColor& color : mesh.surface_colors) color.v = 1 - color.v;
}

// Writes a scene of one ball that is seen from its right, where the texture's two ends meet.
std::filesystem::path ball_scene(const std::filesystem::path& folder, const std::string& surface) {
  test::write_text(folder / "ball.toml", "[[body]]\nsurface = \"" + surface +
                                             "\"\nlabel = \"\"\nvertices = 300\nmaterial = \"jelly\"\n"
                                             "[camera]\nposition = [2.2, 0.9, 0.9]\ntarget = [0, 0.4, 0]\n");
  return folder / "ball.toml";
}

TEST(Golden, TheVerticesOfAFileHaveTheirColours) {
  const test::TemporaryFolder folder;
  const auto rainbow = [](const Vec3& p) {
    return std::array{int(127 + 300 * p.x()), int(127 + 300 * p.y()), int(127 + 300 * p.z())};
  };
  test::write_text(folder.path / "ball.ply", test::ply_text(test::sphere_surface(0.4, 32, 16), rainbow));
  expect_golden("vertex-colors", {ball_scene(folder.path, "ball.ply")},
                {{.on_stage = remove_file_colors}, {{"body.body.colors=body"}}});
}

TEST(Golden, ATextureIsLaidOntoABody) {
  const test::TemporaryFolder folder;
  test::write_text(folder.path / "ball.obj",
                   test::textured_obj(test::textured_ball(0.4, 32, 16), "mtllib ball.mtl\nusemtl skin\n"));
  test::write_text(folder.path / "ball.mtl", "newmtl skin\nmap_Kd squares.png\n");
  write_png(folder.path / "squares.png", 256, 256, test::squares_picture(256, 8));
  expect_golden("texture", {ball_scene(folder.path, "ball.obj")},
                {{.on_stage = remove_file_colors}, {.on_stage = flip_textures}});
}

// The renewed meshes have colours that no mesh had when the film began.
TEST(Renderer, AMeshThatIsRenewedWithPaintLooksAsIfItHadBeenThereFromTheStart) {
  const Picture painted = picture_of({written_for_tests("regions")});
  Stage bare = painted.stage;
  remove_paint(bare);
  Renderer renderer(bare, GlChoice::osmesa, test::source_folder / "shaders");
  const Image before = renderer.draw(painted.list);
  DrawList list = painted.list;
  for (std::size_t m = 0; m < painted.stage.meshes.size(); ++m) list.renewed.emplace_back(m, painted.stage.meshes[m]);
  const Image after = renderer.draw(list);
  EXPECT_NE(before.rgb, after.rgb);
  EXPECT_EQ(after.rgb, draw(painted).rgb);
}

}  // namespace golden_test
}  // namespace supple
